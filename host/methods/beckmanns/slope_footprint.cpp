#include "host/methods/beckmanns/slope_footprint.h"

#include <algorithm>
#include <cmath>

#include "host/methods/gaussians/mixture.h"

namespace mica::host {
namespace {

constexpr double k = kPositionKernelVariance;

Eigen::Array2d spacing(const SlopeLevel& level, const device_types::mica_map_grid& grid) {
  return {static_cast<double>(grid.width) / level.width, static_cast<double>(grid.height) / level.height};
}

/// Whole cells in [0, size), and the rest in [0, 1).
void split(double cells, int size, std::int32_t* whole, float* rest) {
  const double base = std::floor(cells);
  *whole = static_cast<std::int32_t>(base);
  *rest = static_cast<float>(cells - base);
  if (*rest >= 1.0f) *rest = 0.0f, ++*whole;  // rounded up
  *whole %= size;
}

}  // namespace

device_types::mica_slope_footprint to_slope_footprint(const LobeWeights& weights,
                                                      const device_types::mica_map_grid& grid,
                                                      const std::vector<SlopeLevel>& levels,
                                                      double least_variance) {
  device_types::mica_slope_footprint result{};
  // The surface that the weighted lobes see, which are blurred by their kernel.
  const double smallest = weights.sigma.cwiseAbs2().minCoeff() + k;
  const auto kernel = [&](const SlopeLevel& level) {
    return level.width == grid.width && level.height == grid.height ? k : kCellVariance;
  };
  // (kernel + least) (size / cells)^2 <= smallest, both ways and without a division: every query asks every
  // level.
  const double width2 = static_cast<double>(grid.width) * grid.width,
               height2 = static_cast<double>(grid.height) * grid.height;
  const auto fits = [&](const SlopeLevel& level) {
    const double need = kernel(level) + least_variance, w = level.width, h = level.height;
    return need * width2 <= smallest * w * w && need * height2 <= smallest * h * h;
  };
  auto level = std::find_if(levels.rbegin(), levels.rend(), fits);
  if (level == levels.rend()) {
    const SlopeLevel& finest = levels.front();
    if (finest.width != grid.width || finest.height != grid.height) {
      result.offset = -1;
      return result;
    }
    --level;
  }
  const Eigen::Array2d h = spacing(*level, grid);
  Eigen::Matrix2d covariance = weights.covariance();
  covariance.diagonal().array() += k - kernel(*level) * h.square();
  covariance.array() /= (h.matrix() * h.matrix().transpose()).array();
  const double shear = covariance(0, 1) / covariance(1, 1);
  result.offset = static_cast<std::int32_t>(level->offset);
  result.width = level->width, result.height = level->height;
  result.mean_unit = level->mean_unit, result.spread_unit = level->spread_unit;
  split((weights.mean_i + static_cast<double>(weights.mean_x)) / h.x(), level->width, &result.cell_i,
        &result.cell_x);
  split((weights.mean_j + static_cast<double>(weights.mean_y)) / h.y(), level->height, &result.cell_j,
        &result.cell_y);
  result.sigma_y = static_cast<float>(std::sqrt(covariance(1, 1)));
  result.shear = static_cast<float>(shear);
  result.sigma_x = static_cast<float>(std::sqrt(covariance(0, 0) - shear * covariance(0, 1)));
  return result;
}

}  // namespace mica::host
