#include "host/scene/fork.h"

#include <algorithm>
#include <cmath>

#include "host/base/constants.h"
#include "host/scene/curve.h"
#include "host/scene/loft.h"
#include "mica/error.h"

namespace mica::host {
namespace {

constexpr int fork_steps = 320, fork_steps_around = 128, tine_steps = 120, tine_steps_around = 64;

// Lengths in units of the fork's; x runs from the handle's end at -1/2 to the tips of the tines at 1/2.
constexpr double fork_handle_end = 0.035, head_tip = 0.325, head_end = 0.02, tine_root = 0.27;
constexpr double tine_spacing = 0.034, tine_half_width = 0.0098, tine_point = 0.012;

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
    const double length = head_tip + 0.5, x = -0.5 + length * 0.5 * (1 - std::cos(kPi * q));
    const double ends =
        round_off(fork_handle_end - 0.5 - x, fork_handle_end) * round_off(x - head_tip + head_end, head_end);
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
    const double length = 0.5 - tine_root, x = tine_root + length * 0.5 * (1 - std::cos(kPi * q));
    const double ends =
        round_off(tine_root + tine_point - x, tine_point) * round_off(x - 0.5 + tine_point, tine_point);
    // Inside the head a little thinner than it, so that both do not lie in one plane.
    const double thickness = side_.thickness.at(x) * (x < head_tip - head_end ? 0.8 : 1.0);
    const double share = middle_ / 0.061;
    return {
        x, middle_,  width_.at(x) * ends, side_.height.at(x) - 0.006 * hollow_.at(x) * (1 - share * share),
        0, thickness};
  }

 private:
  double middle_;
  Side side_;
  Curve width_{{{tine_root, tine_half_width}, {0.36, tine_half_width}, {0.5, 0.0055}}};
  Curve hollow_{{{0.33, 1}, {0.42, 0}}};
};

}  // namespace

TriangleMesh make_fork(const ForkShape& fork) {
  if (!(fork.center.allFinite() && std::isfinite(fork.size) && fork.size > 0))
    throw UsageError("fork: center must be finite and size positive");
  TriangleMesh mesh;
  add_loft(Handle(), fork_steps, fork_steps_around, &mesh);
  for (const double tine : {-1.5, -0.5, 0.5, 1.5})
    add_loft(Tine(tine * tine_spacing), tine_steps, tine_steps_around, &mesh);
  place_body(fork.center, fork.size, &mesh);
  return mesh;
}

}  // namespace mica::host
