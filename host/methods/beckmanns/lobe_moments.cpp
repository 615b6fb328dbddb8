#include "host/methods/beckmanns/lobe_moments.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "host/methods/gaussians/mixture.h"
#include "host/surface/disk.h"

namespace mica::host {
namespace {

constexpr int kCellReach =
    2;                      // cells on either side of an element's own: 5.9 standard deviations of its kernel
constexpr int kPoints = 3;  // a cell and axis
constexpr int kTaps = (2 * kCellReach + 1) * kPoints;
constexpr std::array<double, kPoints> kNodes = {0.11270166537925831, 0.5, 0.88729833462074169};

/// Weights of the points of the cells about an element. In each cell they integrate the kernel times 1, x and
/// x^2 exactly; together they sum to one.
std::array<double, kTaps> kernel_weights() {
  const double sigma = std::sqrt(kPositionKernelVariance);
  Eigen::Matrix3d powers;
  for (int k = 0; k < kPoints; ++k)
    powers.col(k) << 1, kNodes[k] - 0.5, (kNodes[k] - 0.5) * (kNodes[k] - 0.5);
  const auto cdf = [&](double x) { return 0.5 * std::erfc(-x / (sigma * std::sqrt(2.0))); };
  const auto density = [&](double x) {
    return std::exp(-0.5 * x * x / (sigma * sigma)) / (sigma * std::sqrt(2 * M_PI));
  };
  std::array<double, kTaps> weights{};
  double sum = 0;
  for (int cell = -kCellReach; cell <= kCellReach; ++cell) {
    const double c = cell, a = c - 0.5, b = c + 0.5;
    const double m0 = cdf(b) - cdf(a);
    const double m1 = sigma * sigma * (density(a) - density(b));
    const double m2 = sigma * sigma * (m0 + a * density(a) - b * density(b));
    const Eigen::Vector3d moments(m0, m1 - c * m0, m2 - 2 * c * m1 + c * c * m0);  // about the cell's centre
    const Eigen::Vector3d cell_weights = powers.inverse() * moments;
    for (int k = 0; k < kPoints; ++k) {
      weights[(cell + kCellReach) * kPoints + k] = cell_weights[k];
      sum += cell_weights[k];
    }
  }
  for (double& weight : weights) weight /= sum;
  return weights;
}

/// The bilinear surface at point k of cell a along an axis: the texel before it, and the share of the next.
struct Place {
  int texel;
  double share;
};
Place place_of(int cell, int point, int elements) {
  const int texel = cell >= 0 ? cell / elements : -((-cell + elements - 1) / elements);
  return {texel, (cell - texel * elements + kNodes[point]) / elements};
}

SlopeMoments products(const Eigen::Vector2d& slope) {
  SlopeMoments moments;
  moments << slope.x(), slope.y(), slope.x() * slope.x(), slope.x() * slope.y(), slope.y() * slope.y();
  return moments;
}

}  // namespace

std::vector<SlopeMoments> slope_moments(const Surface& surface, int elements, int first_i, int first_j,
                                        int count) {
  std::vector<SlopeMoments> result(static_cast<std::size_t>(count) * count);
  if (surface.interpolation() == Interpolation::nearest) {
    for (int j = 0; j < count; ++j)
      for (int i = 0; i < count; ++i)
        result[j * count + i] =
            products(slope_from_disk(surface.texel((first_i + i) / elements, (first_j + j) / elements)));
    return result;
  }
  static const std::array<double, kTaps> weights = kernel_weights();
  const int points = (count + 2 * kCellReach) * kPoints;
  // Summed along u, one row of points after the other; then along v.
  std::vector<SlopeMoments> row(points), rows(static_cast<std::size_t>(points) * count);
  for (int y = 0; y < points; ++y) {
    const Place v = place_of(first_j - kCellReach + y / kPoints, y % kPoints, elements);
    for (int x = 0; x < points; ++x) {
      const Place u = place_of(first_i - kCellReach + x / kPoints, x % kPoints, elements);
      const Eigen::Vector2d below =
          (1 - u.share) * surface.texel(u.texel, v.texel) + u.share * surface.texel(u.texel + 1, v.texel);
      const Eigen::Vector2d above = (1 - u.share) * surface.texel(u.texel, v.texel + 1) +
                                    u.share * surface.texel(u.texel + 1, v.texel + 1);
      row[x] = products(slope_from_disk((1 - v.share) * below + v.share * above));
    }
    for (int i = 0; i < count; ++i) {
      SlopeMoments sum = SlopeMoments::Zero();
      for (int tap = 0; tap < kTaps; ++tap) sum += weights[tap] * row[i * kPoints + tap];
      rows[static_cast<std::size_t>(y) * count + i] = sum;
    }
  }
  for (int j = 0; j < count; ++j) {
    for (int i = 0; i < count; ++i) {
      SlopeMoments sum = SlopeMoments::Zero();
      for (int tap = 0; tap < kTaps; ++tap)
        sum += weights[tap] * rows[static_cast<std::size_t>(j * kPoints + tap) * count + i];
      result[j * count + i] = sum;
    }
  }
  return result;
}

Lobe to_lobe(const SlopeMoments& moments) {
  Lobe lobe;
  lobe.mean = moments.head<2>();
  const Eigen::Vector2d& p = lobe.mean;
  Eigen::Matrix2d covariance;
  covariance << moments[2] - p.x() * p.x(), moments[3] - p.x() * p.y(), moments[3] - p.x() * p.y(),
      moments[4] - p.y() * p.y();
  // The slope p = -s / sqrt(1 - |s|^2) changes by B = sqrt(w) (I + p p^T) with s, w = 1 + |p|^2.
  const double w = 1 + p.squaredNorm();
  const Eigen::Matrix2d inverse = (Eigen::Matrix2d::Identity() - p * p.transpose() / w) / std::sqrt(w);
  const Eigen::Matrix2d S = inverse * covariance * inverse;
  lobe.spread_xx = std::sqrt(std::max(S(0, 0), 0.0));
  if (lobe.spread_xx > 0) lobe.spread_yx = S(0, 1) / lobe.spread_xx;
  lobe.spread_yy = std::sqrt(std::max(S(1, 1) - lobe.spread_yx * lobe.spread_yx, 0.0));
  return lobe;
}

}  // namespace mica::host
