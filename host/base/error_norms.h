#pragma once

#include <cmath>
#include <cstddef>

namespace mica::host {

/// The relative L2 error, sqrt(sum (D - ref)^2 / sum ref^2), of pairs that come one by one. Both sums are
/// taken in the order in which pairs come, in double precision, so that the same pairs give the same bits.
class RelativeL2 {
 public:
  /// The difference is taken in the wider of the two types.
  template <typename Value, typename Reference>
  void add(Value value, Reference reference) {
    const double difference = value - reference, expected = reference;
    squares_ += difference * difference;
    reference_squares_ += expected * expected;
  }

  /// Whether there is something to be relative to.
  bool has_reference() const { return reference_squares_ > 0; }

  /// 0 where there is no error; infinite where there is one, and every reference is 0.
  double value() const {
    if (squares_ == 0) return 0;
    return std::sqrt(squares_ / reference_squares_);
  }

 private:
  double squares_ = 0, reference_squares_ = 0;
};

/// The relative L2 error of two sequences of one length.
template <typename Values, typename References>
double relative_l2(const Values& values, const References& references) {
  RelativeL2 error;
  for (std::size_t n = 0; n < references.size(); ++n) error.add(values[n], references[n]);
  return error.value();
}

}  // namespace mica::host
