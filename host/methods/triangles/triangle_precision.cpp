#include "host/methods/triangles/triangle_precision.h"

#include <algorithm>
#include <cmath>

namespace mica::host {
namespace {

/// Share of a Gaussian of four dimensions, two of place and two of the normal, beyond Q = `cutoff`. Where
/// normals change little under the lobe, less is.
double beyond(double cutoff) {
  return (1 + cutoff / 2) * std::exp(-cutoff / 2);
}

}  // namespace

TrianglePrecision triangle_precision(double tolerance) {
  if (tolerance <= kExactTriangles) return {0, -2 * std::log(1e-7), 1};
  const double asked = std::min(tolerance, kRoughTriangles);
  TrianglePrecision precision;
  precision.level = asked < 7e-4 ? 0 : asked < 7e-3 ? 1 : 2;
  // What lies beyond is lost where triangles are small beside footprint and lobe, and hardly any of it where
  // they are large: half of it is given back, and the other half is within the tolerance.
  constexpr double share = 1.4;
  double low = 0, high = 40;
  while (high - low > 1e-6) {
    const double middle = 0.5 * (low + high);
    (beyond(middle) > share * asked ? low : high) = middle;
  }
  precision.cutoff = high;
  precision.kept = 1 - 0.5 * share * asked;
  return precision;
}

}  // namespace mica::host
