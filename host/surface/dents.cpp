#include <fmt/format.h>

#include <cmath>

#include "host/base/random.h"
#include "host/surface/features.h"
#include "host/surface/height_modes.h"
#include "host/surface/settings.h"
#include "host/surface/synthesis.h"

namespace mica::host {
namespace {

enum DentStream : std::uint64_t { dent_u_stream, dent_v_stream, dent_radius_stream };

void check(const DentsSurface& dents) {
  synthesis::check_resolution("dents", dents.resolution);
  synthesis::check_setting("dents", "density", dents.density, 0, 16);
  synthesis::check_setting("dents", "least radius in texels", dents.radius_low_texels, 1, dents.resolution);
  synthesis::check_setting("dents", "greatest radius in texels", dents.radius_high_texels,
                           dents.radius_low_texels, dents.resolution);
  synthesis::check_setting("dents", "depth over radius", dents.depth, 0, 1);
}

}  // namespace

synthesis::Extent Dent::extent() const {
  return {{1, 0}, radius, -radius, radius};
}

Eigen::Vector2d Dent::slope(const Eigen::Vector2d& offset) const {
  const double inside = 1 - offset.squaredNorm() / (radius * radius);
  if (inside <= 0) return {0, 0};
  return 6 * depth / (radius * radius) * inside * inside * offset;
}

std::vector<Dent> place_dents(const DentsSurface& dents) {
  check(dents);
  const double low = dents.radius_low_texels, high = dents.radius_high_texels;
  const double mean_squared_radius = (low * low + low * high + high * high) / 3;
  const double area = static_cast<double>(dents.resolution) * dents.resolution;
  const auto count =
      static_cast<std::uint64_t>(std::llround(dents.density * area / (kPi * mean_squared_radius)));
  std::vector<Dent> placed;
  for (std::uint64_t n = 0; n < count; ++n) {
    const auto unit = [&](DentStream stream) { return random_unit(dents.seed, stream, n); };
    Dent dent;
    dent.center_texels = dents.resolution * Eigen::Vector2d(unit(dent_u_stream), unit(dent_v_stream));
    dent.radius = low + (high - low) * unit(dent_radius_stream);
    dent.depth = dents.depth * dent.radius;
    placed.push_back(dent);
  }
  return placed;
}

std::vector<Eigen::Vector2d> synthesise_dents(const DentsSurface& dents, SurfaceReport& report) {
  const std::vector<Dent> placed = place_dents(dents);
  report.notes.push_back(
      fmt::format("dents: {} dents on {} x {} texels", placed.size(), dents.resolution, dents.resolution));
  return synthesis::normals_of_features(dents.resolution, placed);
}

}  // namespace mica::host
