#include "host/methods/beckmanns/slope_pyramid.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "host/methods/beckmanns/lobe_moments.h"
#include "host/methods/gaussians/mixture.h"

namespace mica::host {
namespace {

constexpr int kPlanes = 5;
constexpr double kFilterReach = 5.5;  // standard deviations of the filter between two levels

/// A row of moments of a level. @param j in [0, height).
using RowOf = std::function<std::vector<SlopeMoments>(int j)>;

/// Moments of a whole level, row by row.
struct Cells {
  int width = 0, height = 0;
  std::vector<SlopeMoments> moments;
};

/// What a cell of the next level takes from this one, along an axis.
struct Taps {
  int first = 0;                // not wrapped
  std::vector<double> weights;  // sum to one
};

/// @param kernel variance of this level's cells, in its spacings^2.
Taps taps_of(int cell, int size, int next_size, double kernel) {
  const double ratio = static_cast<double>(size) / next_size;
  // Kernels grow with their spacing: theirs and this filter's variances add up.
  const double variance = kCellVariance * ratio * ratio - kernel, center = (cell + 0.5) * ratio - 0.5;
  Taps taps;
  if (size == next_size) return {cell, {1.0}};
  const int reach = static_cast<int>(std::ceil(kFilterReach * std::sqrt(variance)));
  taps.first = static_cast<int>(std::floor(center)) - reach;
  double sum = 0;
  for (int n = 0; n <= 2 * reach + 1; ++n) {
    const double x = taps.first + n - center;
    taps.weights.push_back(std::exp(-0.5 * x * x / variance));
    sum += taps.weights.back();
  }
  for (double& weight : taps.weights) weight /= sum;
  return taps;
}

int wrap_cell(int index, int period) {
  const int remainder = index % period;
  return remainder < 0 ? remainder + period : remainder;
}

Cells next_level(int width, int height, double kernel, const RowOf& row_of) {
  Cells next{std::max(width / 2, 1), std::max(height / 2, 1), {}};
  next.moments.assign(static_cast<std::size_t>(next.width) * next.height, SlopeMoments::Zero());
  std::vector<Taps> columns(next.width);
  for (int i = 0; i < next.width; ++i) columns[i] = taps_of(i, width, next.width, kernel);
  tbb::parallel_for(0, next.height, [&](int j) {
    SlopeMoments* out = next.moments.data() + static_cast<std::size_t>(j) * next.width;
    const Taps rows = taps_of(j, height, next.height, kernel);
    for (std::size_t m = 0; m < rows.weights.size(); ++m) {
      const std::vector<SlopeMoments> row = row_of(wrap_cell(rows.first + static_cast<int>(m), height));
      for (int i = 0; i < next.width; ++i) {
        SlopeMoments sum = SlopeMoments::Zero();
        for (std::size_t n = 0; n < columns[i].weights.size(); ++n)
          sum += columns[i].weights[n] * row[wrap_cell(columns[i].first + static_cast<int>(n), width)];
        out[i] += rows.weights[m] * sum;
      }
    }
  });
  return next;
}

/// Moments of a lobe, the inverse of `to_lobe`.
SlopeMoments moments_of(const Lobe& lobe) {
  const Eigen::Vector2d& p = lobe.mean;
  const double root_w = std::sqrt(1 + p.squaredNorm());
  const auto to_slopes = [&](const Eigen::Vector2d& v) {
    return Eigen::Vector2d(root_w * (v + p.dot(v) * p));
  };
  const Eigen::Vector2d first = to_slopes({lobe.spread_xx, lobe.spread_yx}),
                        second = to_slopes({0, lobe.spread_yy});
  SlopeMoments moments;
  moments << p.x(), p.y(), p.x() * p.x() + first.x() * first.x() + second.x() * second.x(),
      p.x() * p.y() + first.x() * first.y() + second.x() * second.y(),
      p.y() * p.y() + first.y() * first.y() + second.y() * second.y();
  return moments;
}

/// Mean, and Cholesky factor of the covariance.
using Numbers = Eigen::Array<double, kPlanes, 1>;
Numbers numbers_of(const SlopeMoments& m) {
  const double xx = std::sqrt(std::max(m[2] - m[0] * m[0], 0.0));
  const double yx = xx > 0 ? (m[3] - m[0] * m[1]) / xx : 0;
  Numbers numbers;
  numbers << m[0], m[1], xx, yx, std::sqrt(std::max(m[4] - m[1] * m[1] - yx * yx, 0.0));
  return numbers;
}

void append(int width, int height, const RowOf& row_of, SlopePyramid* pyramid) {
  constexpr int apron = device_types::MICA_SLOPE_APRON;
  std::vector<Numbers> all(static_cast<std::size_t>(width) * height);
  std::vector<Numbers> largest(height, Numbers::Zero());
  tbb::parallel_for(0, height, [&](int j) {
    const std::vector<SlopeMoments> row = row_of(j);
    for (int i = 0; i < width; ++i) {
      Numbers& numbers = all[static_cast<std::size_t>(j) * width + i];
      numbers = numbers_of(row[i]);
      largest[j] = largest[j].max(numbers.abs());
    }
  });
  Numbers most = Numbers::Constant(1e-12);
  for (const Numbers& row : largest) most = most.max(row);
  SlopeLevel level{width, height, pyramid->numbers.size(),
                   static_cast<float>(most.head<2>().maxCoeff() / kLargest16),
                   static_cast<float>(most.tail<3>().maxCoeff() / kLargest16)};
  const std::size_t row_size = width + apron, plane = row_size * (height + apron);
  pyramid->numbers.resize(pyramid->numbers.size() + kPlanes * plane);
  std::int16_t* out = pyramid->numbers.data() + level.offset;
  tbb::parallel_for(0, height + apron, [&](int j) {
    for (int i = 0; i < width + apron; ++i) {
      const Numbers& numbers = all[static_cast<std::size_t>(j % height) * width + i % width];
      for (int k = 0; k < kPlanes; ++k) {
        const double units = std::round(numbers[k] / (k < 2 ? level.mean_unit : level.spread_unit));
        out[k * plane + j * row_size + i] =
            static_cast<std::int16_t>(std::clamp<double>(units, -kLargest16, kLargest16));
      }
    }
  });
  pyramid->levels.push_back(level);
}

RowOf rows_of(const Cells& cells) {
  return [&cells](int j) {
    const auto first = cells.moments.begin() + static_cast<long>(j) * cells.width;
    return std::vector<SlopeMoments>(first, first + cells.width);
  };
}

}  // namespace

SlopePyramid build_slope_pyramid(const LobeStructure& lobes, bool with_finest) {
  SlopePyramid pyramid;
  const int width = lobes.grid.width, height = lobes.grid.height;
  const RowOf finest = [&](int j) {
    std::vector<SlopeMoments> row(width);
    for (int i = 0; i < width; ++i) row[i] = moments_of(lobes.lobe(i, j));
    return row;
  };
  if (with_finest || (width == 1 && height == 1)) append(width, height, finest, &pyramid);
  if (width == 1 && height == 1) return pyramid;
  Cells cells = next_level(width, height, kPositionKernelVariance, finest);
  append(cells.width, cells.height, rows_of(cells), &pyramid);
  while (cells.width > 1 || cells.height > 1) {
    cells = next_level(cells.width, cells.height, kCellVariance, rows_of(cells));
    append(cells.width, cells.height, rows_of(cells), &pyramid);
  }
  return pyramid;
}

std::size_t slope_pyramid_bytes(int width, int height, bool with_finest) {
  const auto level = [](int w, int h) {
    return static_cast<std::size_t>(w + device_types::MICA_SLOPE_APRON) *
           (h + device_types::MICA_SLOPE_APRON) * kPlanes * sizeof(std::int16_t);
  };
  std::size_t bytes = with_finest || (width == 1 && height == 1) ? level(width, height) : 0;
  while (width > 1 || height > 1) {
    width = std::max(width / 2, 1), height = std::max(height / 2, 1);
    bytes += level(width, height);
  }
  return bytes;
}

}  // namespace mica::host
