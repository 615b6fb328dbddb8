#include "host/microfacet/circle_share.h"

#include <algorithm>
#include <cmath>

#include "host/base/constants.h"

namespace mica::host {
namespace {

double normal_cdf(double x) {
  return 0.5 * std::erfc(-x / std::sqrt(2.0));
}

}  // namespace

double share_in_unit_circle(const Eigen::Vector2d& center, const Eigen::Vector2d& sigma) {
  constexpr double reach = 6;  // standard deviations
  const double radius = center.norm(), largest = reach * sigma.maxCoeff();
  if (radius + largest <= 1) return 1;
  if (radius - largest >= 1) return 0;
  // Along chords at a height y; y = sin(angle) takes the sting out of their ends.
  constexpr int steps = 128;
  const double first = std::asin(std::clamp(center.y() - reach * sigma.y(), -1.0, 1.0)),
               last = std::asin(std::clamp(center.y() + reach * sigma.y(), -1.0, 1.0)),
               step = (last - first) / steps;
  double sum = 0;
  for (int n = 0; n < steps; ++n) {
    const double angle = first + (n + 0.5) * step, half_chord = std::cos(angle);
    const double z = (std::sin(angle) - center.y()) / sigma.y();
    sum += std::exp(-0.5 * z * z) * half_chord *
           (normal_cdf((half_chord - center.x()) / sigma.x()) -
            normal_cdf((-half_chord - center.x()) / sigma.x()));
  }
  return std::min(sum * step / (std::sqrt(2 * kPi) * sigma.y()), 1.0);
}

}  // namespace mica::host
