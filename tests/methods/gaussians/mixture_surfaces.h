// Surfaces on which mixtures are tested, and footprints on them.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "host/base/random.h"
#include "host/surface/surface.h"
#include "host/surface/texel_footprint.h"
#include "host/verify/accuracy.h"

namespace mica::host {

inline Surface mixture_spectrum(double rms_slope = 0.15) {
  return make_surface({"test", SpectrumSurface{256, rms_slope, 8, 3}, Interpolation::bilinear}, nullptr);
}

inline Surface mixture_flakes(Interpolation interpolation) {
  return make_surface({"test", FlakesSurface{128, 12, 0.2, 5}, interpolation}, nullptr);
}

/// Twice as steep a texel as the noise along u, nearly flat along v; a period that is no multiple of a leaf.
inline Surface mixture_brushed() {
  constexpr int width = 203, height = 150;
  std::vector<Eigen::Vector2d> normals;
  for (int j = 0; j < height; ++j) {
    for (int i = 0; i < width; ++i) {
      const double x = 2 * M_PI * i / width, y = 2 * M_PI * j / height;
      normals.emplace_back(0.08 * std::sin(17 * x + std::sin(y)) + 0.06 * std::cos(29 * x - 2 * y),
                           0.02 * std::sin(9 * x + 3 * y));
    }
  }
  return Surface(width, height, Interpolation::bilinear, std::move(normals));
}

/// Footprints of 0.25 to `largest` texels, round to 30:1, each with half vectors on, near and far from its
/// normals.
inline std::vector<std::vector<Query>> mixture_probes(const Surface& surface, double roughness,
                                                      double largest) {
  constexpr int footprints = 12;
  std::vector<std::vector<Query>> all;
  for (int n = 0; n < footprints; ++n) {
    const auto random = [&](std::uint64_t stream) { return random_unit(21, stream, n); };
    const double major = 0.25 * std::pow(largest / 0.25, n / (footprints - 1.0));
    const double minor = std::max(major * std::pow(30, -random(0)), 0.05);
    const Footprint footprint =
        make_footprint(surface, {random(1), random(2)}, major, minor, M_PI * random(3));
    all.push_back(probe(surface, footprint, roughness, 8, n));
  }
  return all;
}

}  // namespace mica::host
