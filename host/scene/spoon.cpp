#include "host/scene/spoon.h"

#include <cmath>

#include "host/base/constants.h"
#include "host/scene/curve.h"
#include "host/scene/loft.h"
#include "mica/error.h"

namespace mica::host {
namespace {

constexpr int kSpoonSteps = 320, kSpoonStepsAround = 160;

// Lengths in units of the spoon's; x runs from the handle's end at -1/2 to the bowl's tip at 1/2.
constexpr double kBowlMiddle = 0.335, kBowlHalfLength = 0.165, kBowlHalfWidth = 0.112, kBowlDepth = 0.042;
constexpr double kSpoonHandleEnd = 0.035;  ///< the handle rounds off over this length

/// How wide an ellipse is at `x` from its middle, as a share of its half width.
double ellipse(double x, double half_length) {
  const double share = x / half_length;
  return share * share < 1 ? std::sqrt(1 - share * share) : 0;
}

class Spoon {
 public:
  LoftSection operator()(double q) const {
    const double x = -0.5 * std::cos(kPi * q);  // closer together at both tips
    // Broadest before the middle, as an egg.
    const double along = (x - kBowlMiddle) / kBowlHalfLength;
    const double egg = kBowlHalfWidth * ellipse(along, 1) * (1 - 0.12 * along);
    double handle = handle_width_.at(x);
    if (x < kSpoonHandleEnd - 0.5) handle *= ellipse(kSpoonHandleEnd - 0.5 - x, kSpoonHandleEnd);
    if (x > kBowlMiddle) handle *= ellipse(along, 1);
    const double width = std::cbrt(egg * egg * egg + handle * handle * handle);
    const double hollow = along * along < 1 ? kBowlDepth * std::pow(1 - along * along, 1.5) : 0;
    return {x, 0, width, rim_.at(x), hollow, thickness_.at(x)};
  }

 private:
  Curve handle_width_{
      {{-0.5, 0.036}, {-0.4, 0.034}, {-0.2, 0.022}, {0.0, 0.014}, {0.12, 0.0125}, {0.5, 0.012}}};
  Curve rim_{{{-0.5, 0.012},
              {-0.3, 0.036},
              {-0.05, 0.066},
              {0.1, 0.072},
              {0.2, 0.058},
              {0.335, 0.049},
              {0.5, 0.054}}};
  Curve thickness_{{{-0.5, 0.009}, {-0.1, 0.011}, {0.12, 0.012}, {0.22, 0.008}, {0.5, 0.006}}};
};

}  // namespace

TriangleMesh make_spoon(const SpoonShape& spoon) {
  if (!(spoon.center.allFinite() && std::isfinite(spoon.size) && spoon.size > 0))
    throw UsageError("spoon: center must be finite and size positive");
  TriangleMesh mesh;
  add_loft(Spoon(), kSpoonSteps, kSpoonStepsAround, &mesh);
  place_body(spoon.center, spoon.size, &mesh);
  return mesh;
}

}  // namespace mica::host
