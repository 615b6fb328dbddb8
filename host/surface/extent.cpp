#include "host/surface/extent.h"

#include <algorithm>
#include <cmath>

namespace mica::host::synthesis {
namespace {

/// Texels whose centres lie in [low, high].
TexelRange texels_between(double low, double high) {
  return {static_cast<long>(std::ceil(low - 0.5)), static_cast<long>(std::floor(high - 0.5))};
}

/// Cuts [*low, *high] to the x with low_value <= slope * x + start <= high_value.
void cut(double slope, double start, double low_value, double high_value, double* low, double* high) {
  if (slope == 0) {
    if (!(low_value <= start && start <= high_value)) *high = *low - 1;
    return;
  }
  const auto [first, last] = std::minmax({(low_value - start) / slope, (high_value - start) / slope});
  *low = std::max(*low, first);
  *high = std::min(*high, last);
}

}  // namespace

TexelRange Extent::rows(double center_v) const {
  const double along = half_length * std::abs(axis.y());
  const auto [low, high] = std::minmax({across_low * axis.x(), across_high * axis.x()});
  return texels_between(center_v - along + low, center_v + along + high);
}

TexelRange Extent::columns(double center_u, double offset_v) const {
  const double reach = half_length + std::max(std::abs(across_low), std::abs(across_high));
  double low = -reach, high = reach;
  cut(axis.x(), offset_v * axis.y(), -half_length, half_length, &low, &high);
  cut(-axis.y(), offset_v * axis.x(), across_low, across_high, &low, &high);
  return texels_between(center_u + low, center_u + high);
}

}  // namespace mica::host::synthesis
