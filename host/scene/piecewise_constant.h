#pragma once

#include <cstddef>
#include <vector>

namespace mica::host {

/// A random choice among items in proportion to weights; the rest of the uniform number is uniform again.
class PiecewiseConstant {
 public:
  PiecewiseConstant() = default;
  /// @param weights >= 0. When all are 0, every item has probability 0, and `sample` must not be called.
  explicit PiecewiseConstant(const std::vector<double>& weights);

  double sum() const { return sum_; }
  double probability(std::size_t item) const {
    return sum_ > 0 ? (cumulative_[item + 1] - cumulative_[item]) / sum_ : 0;
  }

  /// @param uniform in [0, 1), replaced by another such number that is independent of the choice. An item of
  /// probability 0 is never chosen.
  std::size_t sample(double* uniform) const;

 private:
  std::vector<double> cumulative_;  // sums of the weights before each item, then of all
  double sum_ = 0;
};

}  // namespace mica::host
