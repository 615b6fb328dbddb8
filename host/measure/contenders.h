#pragma once

#include <memory>
#include <string>
#include <vector>

#include "host/device/device.h"
#include "host/methods/evaluator.h"
#include "host/methods/registry.h"
#include "host/surface/surface.h"

namespace mica::host::bench {

/// A method of the registry with its knobs set.
struct Contender {
  std::string evaluator;  ///< name of the method
  std::shared_ptr<const Method> method;
  std::shared_ptr<const MethodSettings> settings;
  std::string label, knob;
};

/// Every method that is compared on maps; those whose elements can be chosen once for each of `elements`.
std::vector<Contender> contenders(const MethodRegistry& methods, const std::vector<int>& elements);

/// Whether it is one of a curve over tolerances, and not what jobs ask for by default: measured in cells, and
/// shown nowhere else.
bool is_on_curve(const Contender& contender);
std::vector<Contender> without_curves(std::vector<Contender> contenders);

/// A contender on a surface, ready to answer.
struct Prepared {
  Contender contender;
  std::unique_ptr<Evaluator> evaluator;  ///< null when it does not take the surface
  std::string refused;                   ///< why
  /// The evaluator with a kernel that answers how much it computes in place of densities; null when it cannot
  /// count.
  std::unique_ptr<Evaluator> counter;
  double flops_a_count = 0;  ///< a multiply-add is two
};

/// Builds every contender on the surface, which has to outlive them. Throws DeviceError.
std::vector<Prepared> prepare(const std::vector<Contender>& contenders, Device& device,
                              const Surface& surface);

}  // namespace mica::host::bench
