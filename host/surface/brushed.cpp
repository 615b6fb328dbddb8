#include <fmt/format.h>

#include <cmath>

#include "host/surface/gaussian_heightfield.h"
#include "host/surface/height_modes.h"
#include "host/surface/settings.h"
#include "host/surface/synthesis.h"

namespace mica::host {
namespace {

constexpr double kLeastCorrelation = 1e-3;  // texels; far below what any map resolves

void check(const BrushedSurface& brushed) {
  synthesis::check_resolution("brushed", brushed.resolution);
  synthesis::check_setting("brushed", "rms_slope", brushed.rms_slope, 0, 5);
  synthesis::check_setting("brushed", "correlation along, in texels,", brushed.correlation_along_texels,
                           kLeastCorrelation, brushed.resolution);
  synthesis::check_setting("brushed", "correlation across, in texels,", brushed.correlation_across_texels,
                           kLeastCorrelation, brushed.resolution);
  synthesis::check_setting("brushed", "direction in degrees", brushed.direction_degrees, -360, 360);
}

}  // namespace

std::vector<Eigen::Vector2d> synthesise_brushed(const BrushedSurface& brushed, SurfaceReport& report) {
  check(brushed);
  const double along = brushed.correlation_along_texels, across = brushed.correlation_across_texels;
  if (std::min(along, across) < 2) {
    report.warnings.push_back(fmt::format(
        "brushed: a correlation of {} texels is finer than the texels resolve; the map's is longer "
        "(use 2 or more)",
        std::min(along, across)));
  }
  if (4 * std::max(along, across) > brushed.resolution) {
    report.warnings.push_back(fmt::format(
        "brushed: a correlation of {} texels leaves few features in a period of {}; the map's is shorter",
        std::max(along, across), brushed.resolution));
  }
  const double angle = brushed.direction_degrees * kPi / 180;
  const Eigen::Vector2d a = along * Eigen::Vector2d(std::cos(angle), std::sin(angle));
  const Eigen::Vector2d b = across * Eigen::Vector2d(-std::sin(angle), std::cos(angle));
  return synthesis::gaussian_heightfield(brushed.resolution, brushed.rms_slope,
                                         a * a.transpose() + b * b.transpose(), brushed.seed);
}

}  // namespace mica::host
