#include "host/surface/gaussian_heightfield.h"

#include <cmath>

#include "host/surface/height_modes.h"

namespace mica::host::synthesis {

std::vector<Eigen::Vector2d> gaussian_heightfield(int resolution, double rms_slope,
                                                  const Eigen::Matrix2d& squared_correlation,
                                                  std::uint64_t seed) {
  const auto amplitude = [&](const Eigen::Vector2d& k) {
    return std::exp(-k.dot(squared_correlation * k) / 8);
  };
  // Parseval: E[p^2 + q^2] is the sum of k^2 |H|^2 over all modes.
  const double slope_power = sum_over_modes(resolution, [&](int m, int n) {
    const Eigen::Vector2d k = wave_vector(resolution, m, n);
    return k.squaredNorm() * std::pow(amplitude(k), 2);
  });
  const double scale = rms_slope / std::sqrt(slope_power);
  return normals_of_modes(resolution, [&](int m, int n) {
    return std::polar(scale * amplitude(wave_vector(resolution, m, n)), phase(seed, m, n));
  });
}

}  // namespace mica::host::synthesis
