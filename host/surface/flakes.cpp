#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <cmath>

#include "host/base/constants.h"
#include "host/base/random.h"
#include "host/surface/disk.h"
#include "host/surface/poisson_disk.h"
#include "host/surface/synthesis.h"
#include "mica/error.h"

namespace mica::host {
namespace {

/// Mean distance of neighbouring centres over the least, of the sets that PoissonDisk throws (measured; a
/// test holds it).
constexpr double kMeanOverMinimumDistance = 1.375;

void check(const FlakesSurface& flakes) {
  if (flakes.resolution < 8 || flakes.resolution > 16384) {
    throw UsageError(fmt::format("flakes: resolution is {}, expected 8 to 16384 texels", flakes.resolution));
  }
  if (!(flakes.flake_size_texels >= 2 && 4 * flakes.flake_size_texels <= flakes.resolution)) {
    throw UsageError(
        fmt::format("flakes: flake size is {} texels, expected 2 to a quarter of the resolution ({})",
                    flakes.flake_size_texels, flakes.resolution));
  }
  if (!(flakes.alpha >= 0 && flakes.alpha <= 2)) {
    throw UsageError(fmt::format("flakes: alpha is {}, expected 0 to 2", flakes.alpha));
  }
}

/// A normal on the unit disk with density D, Beckmann's. D is related to the density P22 of slopes by D = P22
/// / cos^4, which is the Jacobian of slope by disk position: to draw from D over the disk is to draw a slope
/// from P22, which is Gaussian with a variance of alpha^2 / 2 an axis. [Walter07] Eq. 28 in slope space.
Eigen::Vector2d beckmann_normal(double alpha, std::uint64_t seed, std::uint64_t flake) {
  const std::uint64_t stream = 1u << 20;  // beyond those of PoissonDisk
  const double slope = alpha * std::sqrt(-std::log1p(-random_unit(seed, stream, flake)));
  const double angle = 2 * kPi * random_unit(seed, stream + 1, flake);
  return disk_from_slope({slope * std::cos(angle), slope * std::sin(angle)});
}

}  // namespace

Flakes synthesise_flakes(const FlakesSurface& description, SurfaceReport& report) {
  check(description);
  const int size = description.resolution;
  const synthesis::PoissonDisk disk(size, description.flake_size_texels / kMeanOverMinimumDistance,
                                    description.seed);

  Flakes flakes;
  flakes.centers_texels = disk.points();
  for (std::size_t flake = 0; flake < flakes.centers_texels.size(); ++flake) {
    flakes.normals.push_back(beckmann_normal(description.alpha, description.seed, flake));
  }
  flakes.flake_of_texel.resize(static_cast<std::size_t>(size) * size);
  tbb::parallel_for(0, size, [&](int j) {
    for (int i = 0; i < size; ++i) {
      flakes.flake_of_texel[static_cast<std::size_t>(j) * size + i] = disk.nearest({i + 0.5, j + 0.5});
    }
  });
  report.notes.push_back(
      fmt::format("flakes: {} flakes on {} x {} texels", flakes.normals.size(), size, size));
  return flakes;
}

std::vector<Eigen::Vector2d> Flakes::texel_normals() const {
  std::vector<Eigen::Vector2d> texels;
  texels.reserve(flake_of_texel.size());
  for (const std::uint32_t flake : flake_of_texel) texels.push_back(normals[flake]);
  return texels;
}

}  // namespace mica::host
