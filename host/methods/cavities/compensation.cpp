#include "host/methods/cavities/compensation.h"

#include <algorithm>
#include <cmath>

#include "host/base/constants.h"

namespace mica::host {
namespace {

double normal_cdf(double x) {
  return 0.5 * std::erfc(-x / std::sqrt(2.0));
}

}  // namespace

double specular_lobe_sigma(double roughness) {
  return 2 * roughness;
}

double share_in_unit_circle(double radius, double sigma) {
  constexpr double reach = 6;  // standard deviations
  if (radius + reach * sigma <= 1) return 1;
  // Along chords that lie y from the centre; y = sin(angle) takes the sting out of their ends.
  constexpr int steps = 128;
  const double last = std::asin(std::min(1.0, reach * sigma)), step = 2 * last / steps;
  double sum = 0;
  for (int n = 0; n < steps; ++n) {
    const double angle = (n + 0.5) * step - last, z = std::sin(angle) / sigma, half_chord = std::cos(angle);
    sum += std::exp(-0.5 * z * z) * half_chord *
           (normal_cdf((half_chord - radius) / sigma) - normal_cdf((-half_chord - radius) / sigma));
  }
  return std::min(sum * step / (std::sqrt(2 * kPi) * sigma), 1.0);
}

double compensation(Compensation kind, const Eigen::Vector3d& view, const Eigen::Vector3d& light,
                    double roughness) {
  if (!(view.z() > 0 && light.z() > 0)) return 0;
  if (kind == Compensation::diffuse) return light.z() / kPi;
  const double sigma = specular_lobe_sigma(roughness);
  const double squared = (light + view).head<2>().squaredNorm() / (sigma * sigma);
  if (squared > 80) return 0;  // below 1e-17 of the peak
  // i_z di is the area of (i_x, i_y).
  return light.z() * std::exp(-0.5 * squared) /
         (2 * kPi * sigma * sigma * share_in_unit_circle(view.head<2>().norm(), sigma));
}

}  // namespace mica::host
