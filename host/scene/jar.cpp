#include "host/scene/jar.h"

#include <cmath>

#include "host/base/constants.h"
#include "host/scene/loft.h"
#include "host/scene/outline.h"
#include "mica/error.h"

namespace mica::host {
namespace {

// Distance from the axis and height, in units of the jar's height.
constexpr double kWidest = 0.43;

std::vector<OutlineCorner> body() {
  return {{{0, 0}, 0},          {{0.36, 0}, 0.04},     {{kWidest, 0.28}, 0.3},
          {{0.40, 0.62}, 0.12}, {{0.30, 0.695}, 0.03}, {{0.30, 0.75}, 0}};
}

std::vector<OutlineCorner> lid() {
  return {{{0.29, 0.725}, 0},     {{0.345, 0.725}, 0.008}, {{0.35, 0.83}, 0.028},
          {{0.2, 0.875}, 0.2},    {{0.052, 0.888}, 0.018}, {{0.045, 0.925}, 0.016},
          {{0.072, 0.96}, 0.024}, {{0.05, 0.995}, 0.02},   {{0, 1}, 0}};
}

}  // namespace

TriangleMesh make_jar(const JarShape& jar) {
  if (!(jar.center.allFinite() && std::isfinite(jar.size) && jar.size > 0))
    throw UsageError("jar: center must be finite and size positive");
  TriangleMesh mesh;
  const double circumference = 2 * kPi * kWidest;
  add_revolved(rounded_outline(body()), circumference, "body", &mesh);
  add_revolved(rounded_outline(lid()), circumference, "lid", &mesh);
  place_body(jar.center, jar.size, &mesh);
  return mesh;
}

}  // namespace mica::host
