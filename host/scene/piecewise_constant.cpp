#include "host/scene/piecewise_constant.h"

#include <algorithm>

namespace mica::host {

PiecewiseConstant::PiecewiseConstant(const std::vector<double>& weights) {
  cumulative_.reserve(weights.size() + 1);
  cumulative_.push_back(0);
  for (const double weight : weights) cumulative_.push_back(cumulative_.back() + weight);
  sum_ = cumulative_.back();
}

std::size_t PiecewiseConstant::sample(double* uniform) const {
  const double target = *uniform * sum_;
  // The last item that begins at or before the target; of those without width that begin there too, none.
  auto next = std::upper_bound(cumulative_.begin(), cumulative_.end(), target);
  if (next == cumulative_.end()) next = std::lower_bound(cumulative_.begin(), cumulative_.end(), sum_);
  const std::size_t item = static_cast<std::size_t>(next - cumulative_.begin()) - 1;
  const double rest = (target - cumulative_[item]) / (cumulative_[item + 1] - cumulative_[item]);
  *uniform = std::clamp(rest, 0.0, 1 - 0x1p-53);
  return item;
}

}  // namespace mica::host
