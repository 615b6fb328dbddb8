#include "host/methods/cavities/footprint_energy.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "host/base/constants.h"
#include "host/surface/disk.h"

namespace mica::host {
namespace {

constexpr double kMaxSlope = 20;  // steeper facets would hide all others in a second moment
constexpr int kAzimuths = 6;  // of the views of a comparison, over half a turn: facets and duals are alike
constexpr double kMargin = 0.95;  // between the views of a comparison, and between squares

/// Polar angles of the views of a comparison, two a band.
constexpr std::array<double, 8> kPolarDegrees = {0, 20, 40, 55, 68, 78, 85, 89};

/// Share of light that leaves after one bounce. [Che19] Eq. 8, as in kernels/cavities/cavity.h
float facet_energy(const Eigen::Vector2f& facet, const Eigen::Vector3f& view) {
  const float squared_cosine = 1 - facet.squaredNorm();
  if (!(squared_cosine > 0)) return 0;
  const float tilt = std::abs(facet.dot(view.head<2>())) / std::sqrt(squared_cosine);
  const float towards = view.z() + tilt, away = std::max(view.z() - tilt, 0.0f);
  const auto leaves = [&](float area) {
    return std::min(std::max(4 * squared_cosine * area - 2 * view.z(), 0.0f), area);
  };
  return (leaves(towards) + leaves(away)) / (towards + away);
}

/// Weights of the bands for a view: one band, or two neighbours in between.
template <int kBands>
Eigen::Array<double, kBands, 1> band_weights(double cosine) {
  Eigen::Array<double, kBands, 1> weights = Eigen::Array<double, kBands, 1>::Zero();
  int band = 0;
  double share = 0;  // of the next band
  for (; band + 1 < kBands; ++band) {
    const double last = std::cos(kPolarDegrees[2 * band + 1] * kPi / 180),
                 next = std::cos(kPolarDegrees[2 * band + 2] * kPi / 180);
    share = std::clamp((last - cosine) / (last - next), 0.0, 1.0);
    if (share < 1) break;
  }
  if (band + 1 == kBands) share = 0;
  weights[band] = 1 - share;
  if (share > 0) weights[band + 1] = share;
  return weights;
}

/// One number a square, and their means over four.
struct Losses {
  int width, height;
  std::vector<float> values;

  float at(int i, int j) const { return values[static_cast<std::size_t>(j % height) * width + i % width]; }
};

Losses losses_of(const Surface& surface, int width, int height, int side, const Eigen::Vector3f& view) {
  Losses losses{width, height, std::vector<float>(static_cast<std::size_t>(width) * height)};
  tbb::parallel_for(0, height, [&](int row) {
    for (int column = 0; column < width; ++column) {
      float sum = 0;
      for (int j = 0; j < side; ++j)
        for (int i = 0; i < side; ++i)
          sum += 1 - facet_energy(surface.texel(column * side + i, row * side + j).cast<float>(), view);
      losses.values[static_cast<std::size_t>(row) * width + column] = sum / static_cast<float>(side * side);
    }
  });
  return losses;
}

Losses halved(const Losses& fine, int width, int height) {
  Losses coarse{width, height, std::vector<float>(static_cast<std::size_t>(width) * height)};
  for (int j = 0; j < height; ++j) {
    for (int i = 0; i < width; ++i) {
      const int right = std::min(2 * i + 1, fine.width - 1), up = std::min(2 * j + 1, fine.height - 1);
      coarse.values[static_cast<std::size_t>(j) * width + i] =
          (fine.at(2 * i, 2 * j) + fine.at(right, 2 * j) + fine.at(2 * i, up) + fine.at(right, up)) / 4;
    }
  }
  return coarse;
}

/// E[p], E[q], E[p^2], E[pq], E[q^2] of slopes; in double precision, since variances are small differences of
/// these.
using Moments = FootprintPyramid<5, double>;

Moments moments_of(const Surface& surface) {
  constexpr int side = Moments::kFirstSide;
  Moments moments(surface.width(), surface.height());
  Moments::Level& finest = moments.levels().front();
  tbb::parallel_for(0, finest.height, [&](int row) {
    for (int column = 0; column < finest.width; ++column) {
      Eigen::Array<double, 5, 1> sums = Eigen::Array<double, 5, 1>::Zero();
      for (int n = 0; n < side * side; ++n) {
        Eigen::Vector2d slope =
            slope_from_disk(surface.texel(column * side + n % side, row * side + n / side));
        slope *= std::min(1.0, kMaxSlope / std::max(slope.norm(), 1e-300));
        Eigen::Array<double, 5, 1> products;
        products << slope.x(), slope.y(), slope.x() * slope.x(), slope.x() * slope.y(), slope.y() * slope.y();
        sums += products;
      }
      finest.square(column, row) = sums / (side * side);
    }
  });
  moments.average_up();
  return moments;
}

}  // namespace

FootprintEnergy::FootprintEnergy(const Surface& surface)
    : width_(surface.width()), height_(surface.height()), pyramid_(surface.width(), surface.height()) {
  const Moments moments = moments_of(surface);
  for (std::size_t n = 0; n < moments.levels().size(); ++n) {
    const std::vector<Moments::Square>& from = moments.levels()[n].squares;
    std::vector<Pyramid::Square>& to = pyramid_.levels()[n].squares;
    tbb::parallel_for(std::size_t{0}, from.size(), [&](std::size_t k) {
      const Moments::Square& m = from[k];
      const double xx = m[2] - m[0] * m[0], xy = m[3] - m[0] * m[1], yy = m[4] - m[1] * m[1];
      const double middle = 0.5 * (xx + yy), root = std::hypot(0.5 * (xx - yy), xy);
      const double cosine = root > 0 ? 0.5 * (xx - yy) / root : 1, sine = root > 0 ? xy / root : 0;
      to[k] << static_cast<float>(std::max(middle + root, 0.0)),
          static_cast<float>(std::max(middle - root, 0.0)), static_cast<float>(cosine),
          static_cast<float>(sine), 1, 1, 1, 1;
    });
  }
  for (std::size_t n = 0; n < kPolarDegrees.size(); ++n) {
    const double polar = kPolarDegrees[n] * kPi / 180;
    for (int azimuth = 0; azimuth < (n == 0 ? 1 : kAzimuths); ++azimuth) {
      const double angle = kPi * azimuth / kAzimuths;
      compare(surface,
              {std::sin(polar) * std::cos(angle), std::sin(polar) * std::sin(angle), std::cos(polar)},
              static_cast<int>(n / 2));
    }
  }
}

double FootprintEnergy::gaussian_lost(const Pyramid::Square& square, const Eigen::Vector3d& view,
                                      double scale, double own) const {
  // cos^2 of the angle between the view and the major axis, by the double angle.
  const double x = view.x(), y = view.y(), squared = x * x + y * y;
  const double double_cosine =
      squared > 0 ? ((x * x - y * y) * square[kDoubleCosine] + 2 * x * y * square[kDoubleSine]) / squared : 0;
  const double share = 0.5 * (1 + double_cosine);
  const auto energy = [&](double variance) {
    return table_.energy(std::sqrt(2 * (scale * variance + own)), view.z());
  };
  return std::clamp(1 - share * energy(square[kMajor]) - (1 - share) * energy(square[kMinor]), 0.0,
                    1.0);  // Eq. 18
}

void FootprintEnergy::compare(const Surface& surface, const Eigen::Vector3d& view, int band) {
  std::vector<Pyramid::Level>& levels = pyramid_.levels();
  Losses losses =
      losses_of(surface, levels[0].width, levels[0].height, Pyramid::kFirstSide, view.cast<float>());
  for (std::size_t n = 0; n < levels.size(); ++n) {
    std::vector<Pyramid::Square>& squares = levels[n].squares;
    if (n > 0) losses = halved(losses, levels[n].width, levels[n].height);
    tbb::parallel_for(std::size_t{0}, squares.size(), [&](std::size_t k) {
      const double gaussian = gaussian_lost(squares[k], view, 1, 0);
      float& share = squares[k][kShares + band];
      if (gaussian > losses.values[k])
        share = std::min(share, static_cast<float>(losses.values[k] / gaussian));
    });
  }
}

double FootprintEnergy::lost(const ViewQuery& query) const {
  const Eigen::Vector2d size(width_, height_);
  const Eigen::Matrix2d to_texels = size.asDiagonal();
  const Eigen::Vector2d mean_uv = query.footprint.mean_uv.array() - query.footprint.mean_uv.array().floor();
  const Eigen::Matrix2d cov_texels = to_texels * query.footprint.cov_uv * to_texels;
  const double narrow =
      std::min(0.5 * cov_texels.trace() / (Pyramid::finest_sigma * Pyramid::finest_sigma), 1.0);
  const Eigen::Array<double, kBands, 1> bands = band_weights<kBands>(query.view.z());
  const double own = query.roughness * query.roughness;
  return kMargin * narrow *
         pyramid_.average(mean_uv.cwiseProduct(size), cov_texels, [&](const Pyramid::Square& square) {
           const double share = (bands * square.tail<kBands>().cast<double>()).sum();
           return share * gaussian_lost(square, query.view, narrow, own);
         });
}

std::size_t FootprintEnergy::bytes() const {
  return pyramid_.bytes() + sizeof(float) * EnergyTable::kSide * EnergyTable::kSide;
}

std::size_t footprint_energy_bytes(int width, int height) {
  std::size_t squares = 0;
  int across = (width + 3) / 4, up = (height + 3) / 4;
  for (;; across = (across + 1) / 2, up = (up + 1) / 2) {
    squares += static_cast<std::size_t>(across) * up;
    if (across == 1 && up == 1) break;
  }
  return squares * 8 * sizeof(float) + sizeof(float) * EnergyTable::kSide * EnergyTable::kSide;
}

}  // namespace mica::host
