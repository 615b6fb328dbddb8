#include <fmt/format.h>

#include <cmath>

#include "host/base/random.h"
#include "host/surface/features.h"
#include "host/surface/height_modes.h"
#include "host/surface/settings.h"
#include "host/surface/synthesis.h"

namespace mica::host {
namespace {

enum BumpStream : std::uint64_t { bump_u_stream, bump_v_stream, bump_angle_stream };

constexpr double kLeastSize = 1e-3;

void check(const BumpsSurface& bumps) {
  synthesis::check_resolution("bumps", bumps.resolution);
  synthesis::check_setting("bumps", "cell in texels", bumps.cell_texels, 4, bumps.resolution);
  synthesis::check_setting("bumps", "size", bumps.size, kLeastSize, 2);
  synthesis::check_setting("bumps", "aspect", bumps.aspect, 1, 10);
  synthesis::check_setting("bumps", "slope", bumps.slope, 0, 5);
  synthesis::check_setting("bumps", "jitter", bumps.jitter, 0, 1);
}

}  // namespace

synthesis::Extent Bump::extent() const {
  return {long_axis, half_length, -half_width, half_width};
}

Eigen::Vector2d Bump::slope(const Eigen::Vector2d& offset) const {
  const Eigen::Vector2d short_axis(-long_axis.y(), long_axis.x());
  const double x = long_axis.dot(offset) / half_length, y = short_axis.dot(offset) / half_width;
  const double squared_radius_here = x * x + y * y;
  if (squared_radius_here >= 1) return {0, 0};
  // The height is half_width sqrt(squared_radius - x^2 - y^2) and a constant.
  const double z = std::sqrt(squared_radius - squared_radius_here);
  return -(x / z * half_width / half_length) * long_axis - y / z * short_axis;
}

std::vector<Bump> place_bumps(const BumpsSurface& bumps) {
  check(bumps);
  const long cells = std::lround(bumps.resolution / bumps.cell_texels);
  const double cell = static_cast<double>(bumps.resolution) / static_cast<double>(cells);
  std::vector<Bump> placed;
  if (bumps.slope == 0) return placed;  // it would be an ellipsoid without end
  for (long n = 0; n < cells * cells; ++n) {
    const auto unit = [&](BumpStream stream) {
      return random_unit(bumps.seed, stream, static_cast<std::uint64_t>(n));
    };
    const long column = n % cells, row = n / cells;
    const Eigen::Vector2d middle(static_cast<double>(column) + 0.5, static_cast<double>(row) + 0.5);
    const double angle = 2 * kPi * unit(bump_angle_stream);
    Bump bump;
    bump.center_texels = cell * (middle + bumps.jitter * Eigen::Vector2d(unit(bump_u_stream) - 0.5,
                                                                         unit(bump_v_stream) - 0.5));
    bump.long_axis = {std::cos(angle), std::sin(angle)};
    bump.half_length = bumps.size * cell / 2;
    bump.half_width = bump.half_length / bumps.aspect;
    bump.squared_radius = 1 + 1 / (bumps.slope * bumps.slope);
    placed.push_back(bump);
  }
  return placed;
}

std::vector<Eigen::Vector2d> synthesise_bumps(const BumpsSurface& bumps, SurfaceReport& report) {
  const std::vector<Bump> placed = place_bumps(bumps);
  report.notes.push_back(
      fmt::format("bumps: {} bumps on {} x {} texels", placed.size(), bumps.resolution, bumps.resolution));
  return synthesis::normals_of_features(bumps.resolution, placed);
}

}  // namespace mica::host
