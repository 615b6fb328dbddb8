#pragma once

#include <algorithm>
#include <cmath>

namespace mica::host::reference {

/// Collects an integral of exp(-q/2) du from pieces and decides how accurate the next piece must be, so that
/// the whole keeps a relative tolerance. Where the integrand is f, an error of tolerance * max(f, floor) per
/// area is allowed: the floor is a small part of the mean over the effective area of what was found so far,
/// so far-off pieces may be coarse.
class RunningIntegral {
 public:
  static constexpr double largest_q = 300;  ///< exp(-q/2) is taken for 0 beyond; D is then below all floats

  /// @param effective_area the area that matters, in texels^2
  RunningIntegral(double tolerance, double effective_area)
      : log_tolerance_(std::log(tolerance)), effective_area_(effective_area) {}

  double sum() const { return sum_; }
  double error() const { return error_; }

  void add(double value, double error) {
    sum_ += value;
    error_ += error;
  }
  /// Leaves out a piece of which q is a lower bound.
  void skip(double area, double q) {
    if (q < largest_q) error_ += area * std::exp(-0.5 * q);
  }

  /// A proven lower bound of the integral, for the time when nothing was found yet.
  void promise(double lower_bound) {
    promised_ = std::max(promised_, lower_bound);
    update();
  }
  /// Makes use of what was added since the last call.
  void update() {
    const double floor = std::max(sum_, promised_) / (tail_areas * effective_area_);
    if (floor > 0) q_floor_ = std::min(-2 * std::log(floor), largest_q);
  }

  bool found_something() const { return std::max(sum_, promised_) > 0; }
  /// Pieces of q above this may be skipped.
  double cut() const {
    return found_something() ? std::min(q_floor_ - 2 * log_tolerance_, largest_q) : largest_q;
  }
  /// Relative error that a piece may have in which q is nowhere less; in digits, rounded to the safe side.
  double tolerance_at(double q) const { return std::exp(std::min(0.0, log_tolerance_at(q))); }
  int digits_at(double q) const {
    constexpr double ln10 = 2.302585092994045684;
    return 1 + static_cast<int>(std::max(0.0, -log_tolerance_at(q)) / ln10);
  }
  /// Whether an error is allowed for a piece.
  bool allows(double error, double value, double area) const {
    return error <= std::exp(log_tolerance_) * std::max(value, area * std::exp(-0.5 * q_floor_));
  }

 private:
  double log_tolerance_at(double q) const { return log_tolerance_ + std::max(0.0, 0.5 * (q - q_floor_)); }

  static constexpr double tail_areas =
      40;  ///< pieces that are not skipped cover about this many effective areas

  double log_tolerance_, effective_area_;
  double sum_ = 0, error_ = 0, promised_ = 0;
  double q_floor_ = largest_q;
};

}  // namespace mica::host::reference
