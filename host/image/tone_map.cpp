#include <algorithm>
#include <cmath>

#include "host/image/image.h"

namespace mica::host {
namespace {

/// Identity up to the knee, then an exponential approach to 1 with the same slope at the knee.
double roll_off(double value) {
  constexpr double knee = 0.8;
  if (value <= knee) return value;
  return 1 - (1 - knee) * std::exp(-(value - knee) / (1 - knee));
}

/// [Narkowicz16]'s fit; beyond 1e3, where it has long been 1, its squares could overflow.
double film_curve(double value) {
  const double x = std::min(value, 1e3);
  return std::min(1.0, x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14));
}

}  // namespace

double tone_mapped(ToneMap tone_map, double radiance) {
  switch (tone_map) {
    case ToneMap::clamp:
      return std::min(radiance, 1.0);
    case ToneMap::shoulder:
      return roll_off(radiance);
    case ToneMap::reinhard:
      return std::isinf(radiance) ? 1 : radiance / (1 + radiance);
    case ToneMap::filmic:
      return film_curve(radiance);
  }
  return 0;
}

}  // namespace mica::host
