#include "host/scene/fork.h"

#include <algorithm>
#include <cmath>

#include "host/base/constants.h"
#include "host/scene/curve.h"
#include "host/scene/loft.h"
#include "mica/error.h"

namespace mica::host {
namespace {

constexpr int kForkSteps = 320, kForkStepsAround = 128, kTineSteps = 120, kTineStepsAround = 64;

// Lengths in units of the fork's; x runs from the handle's end at -1/2 to the tips of the tines at 1/2.
constexpr double kForkHandleEnd = 0.035, kHeadTip = 0.325, kHeadEnd = 0.02, kTineRoot = 0.27;
constexpr double kTineSpacing = 0.034, kTineHalfWidth = 0.0098, kTinePoint = 0.012;

double round_off(double beyond, double length) {
  const double share = std::clamp(beyond / length, 0.0, 1.0);
  return std::sqrt(1 - share * share);
}

/// What handle, head and tines share: seen from the side they are one curve.
struct Side {
  Curve height{{{-0.5, 0.012},
                {-0.3, 0.034},
                {-0.05, 0.062},
                {0.1, 0.064},
                {0.2, 0.044},
                {0.3, 0.022},
                {0.4, 0.015},
                {0.5, 0.028}}};
  Curve thickness{{{-0.5, 0.009}, {-0.1, 0.011}, {0.12, 0.012}, {0.25, 0.010}, {0.34, 0.009}, {0.5, 0.005}}};
};

/// Handle and head.
class Handle {
 public:
  LoftSection operator()(double q) const {
    const double length = kHeadTip + 0.5, x = -0.5 + length * 0.5 * (1 - std::cos(kPi * q));
    const double ends =
        round_off(kForkHandleEnd - 0.5 - x, kForkHandleEnd) * round_off(x - kHeadTip + kHeadEnd, kHeadEnd);
    return {x, 0, width_.at(x) * ends, side_.height.at(x), 0.006 * hollow_.at(x), side_.thickness.at(x)};
  }

 private:
  Side side_;
  Curve width_{{{-0.5, 0.036},
                {-0.4, 0.034},
                {-0.2, 0.022},
                {0.0, 0.014},
                {0.1, 0.0135},
                {0.16, 0.024},
                {0.22, 0.053},
                {0.27, 0.0605},
                {0.33, 0.061}}};
  Curve hollow_{{{0.12, 0}, {0.24, 1}, {0.33, 1}}};
};

class Tine {
 public:
  explicit Tine(double middle) : middle_(middle) {}

  LoftSection operator()(double q) const {
    const double length = 0.5 - kTineRoot, x = kTineRoot + length * 0.5 * (1 - std::cos(kPi * q));
    const double ends =
        round_off(kTineRoot + kTinePoint - x, kTinePoint) * round_off(x - 0.5 + kTinePoint, kTinePoint);
    // Inside the head a little thinner than it, so that both do not lie in one plane.
    const double thickness = side_.thickness.at(x) * (x < kHeadTip - kHeadEnd ? 0.8 : 1.0);
    const double share = middle_ / 0.061;
    return {
        x, middle_,  width_.at(x) * ends, side_.height.at(x) - 0.006 * hollow_.at(x) * (1 - share * share),
        0, thickness};
  }

 private:
  double middle_;
  Side side_;
  Curve width_{{{kTineRoot, kTineHalfWidth}, {0.36, kTineHalfWidth}, {0.5, 0.0055}}};
  Curve hollow_{{{0.33, 1}, {0.42, 0}}};
};

}  // namespace

TriangleMesh make_fork(const ForkShape& fork) {
  if (!(fork.center.allFinite() && std::isfinite(fork.size) && fork.size > 0))
    throw UsageError("fork: center must be finite and size positive");
  TriangleMesh mesh;
  add_loft(Handle(), kForkSteps, kForkStepsAround, &mesh);
  for (const double tine : {-1.5, -0.5, 0.5, 1.5})
    add_loft(Tine(tine * kTineSpacing), kTineSteps, kTineStepsAround, &mesh);
  place_body(fork.center, fork.size, &mesh);
  return mesh;
}

}  // namespace mica::host
