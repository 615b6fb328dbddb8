// Maps, footprints and views on which the tests look at V-shaped cavities.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "host/base/query.h"
#include "host/base/random.h"
#include "host/surface/disk.h"
#include "host/surface/surface.h"

namespace mica::host::cavity_cases {

struct Case {
  std::string name;
  Surface surface;
};

template <typename Kind>
Surface make(const Kind& kind, Interpolation interpolation = Interpolation::bilinear) {
  return make_surface({"test", kind, interpolation}, nullptr);
}

/// Beckmann roughness 0.5 along both axes.
inline Surface rough(int resolution = 256) {
  SpectrumSurface spectrum;
  spectrum.resolution = resolution;
  spectrum.rms_slope = 0.5;
  return make(spectrum);
}

inline Surface scratched(int resolution = 256) {
  ScratchesSurface scratches;
  scratches.resolution = resolution;
  scratches.length_texels = 100;
  scratches.depth_texels = 1.5;
  return make(scratches);
}

/// Beckmann roughness 0.5 along u and 0.1 along v.
inline Surface brushed(int resolution = 256) {
  BrushedSurface brushed;
  brushed.resolution = resolution;
  brushed.rms_slope = std::sqrt((0.5 * 0.5 + 0.1 * 0.1) / 2);
  brushed.correlation_across_texels = 6;
  brushed.correlation_along_texels = 30;  // slopes are as 1 to 5
  brushed.direction_degrees = 90;
  return make(brushed);
}

/// The three of [Che19] Fig. 11.
inline std::vector<Case> figure_11(int resolution = 256) {
  return {
      {"rough", rough(resolution)}, {"scratched", scratched(resolution)}, {"brushed", brushed(resolution)}};
}

/// A footprint by its standard deviations in texels along the axes of the map.
inline Footprint footprint(const Surface& surface, const Eigen::Vector2d& mean_uv, double sigma_u,
                           double sigma_v) {
  const Eigen::Vector2d sigma_uv(sigma_u / surface.width(), sigma_v / surface.height());
  return {mean_uv, sigma_uv.cwiseAbs2().asDiagonal()};
}

inline Eigen::Vector3d direction(double polar_degrees, double azimuth_degrees) {
  const double polar = polar_degrees * M_PI / 180, azimuth = azimuth_degrees * M_PI / 180;
  return {std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), std::cos(polar)};
}

inline double uniform(std::uint64_t stream, std::uint64_t index) {
  return random_unit(11, stream, index);
}

/// The n-th of a row of views: all polar angles up to 89.99 degrees.
inline ViewQuery random_view(const Surface& surface, std::uint64_t n, double roughness) {
  const double sigma = std::pow(10, 2 * uniform(0, n) - 0.5), aspect = std::pow(4, uniform(1, n));
  return {footprint(surface, {uniform(2, n), uniform(3, n)}, sigma, sigma / aspect),
          direction(89.99 * std::sqrt(uniform(4, n)), 360 * uniform(5, n)), roughness};
}

}  // namespace mica::host::cavity_cases
