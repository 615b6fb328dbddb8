#pragma once

#include <memory>
#include <string>
#include <vector>

#include "host/device/device.h"
#include "host/engine/evaluator.h"
#include "host/surface/surface.h"

namespace mica::bench {

/// An evaluator of the registry with its knobs set.
struct Contender {
  std::string evaluator;
  int elements = 1;
  std::string label, knob;
};

/// Every evaluator that `make_evaluator` knows; those whose elements can be chosen once for each of
/// `elements`.
std::vector<Contender> contenders(const std::vector<int>& elements);

/// Throws what make_evaluator throws: a contender may not take the surface.
std::unique_ptr<Evaluator> make(const Contender& contender, Device& device, const Surface& surface);

/// The contender with a kernel that answers how much it computes in place of densities.
struct Counter {
  std::unique_ptr<Evaluator> evaluator;  ///< null for a contender that cannot count
  double flops_a_count = 0;              ///< a multiply-add is two
};
Counter make_counter(const Contender& contender, Device& device, const Surface& surface);

}  // namespace mica::bench
