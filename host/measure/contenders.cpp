#include "host/measure/contenders.h"

#include <algorithm>

#include "host/job/job.h"
#include "mica/error.h"

namespace mica::host::bench {

std::vector<Contender> contenders(const MethodRegistry& methods, const std::vector<int>& elements) {
  std::vector<Contender> all;
  for (const auto& method : methods.all()) {
    const MethodTraits traits = method->traits();
    if (!traits.compared || !traits.map) continue;
    for (MethodVariant& variant : method->variants(elements))
      all.push_back({method->name(), method, std::move(variant.settings), variant.label, variant.knob});
  }
  return all;
}

bool is_on_curve(const Contender& contender) {
  const double usual = AccuracySettings().tolerance;
  return contender.settings->tolerance.value_or(usual) != usual;
}

std::vector<Contender> without_curves(std::vector<Contender> contenders) {
  contenders.erase(std::remove_if(contenders.begin(), contenders.end(), is_on_curve), contenders.end());
  return contenders;
}

std::vector<Prepared> prepare(const std::vector<Contender>& contenders, Device& device,
                              const Surface& surface) {
  std::vector<Prepared> all;
  for (const Contender& contender : contenders) {
    Prepared prepared;
    prepared.contender = contender;
    try {
      prepared.evaluator = contender.method->make(&device, &surface, *contender.settings);
      OperationCounter counter = contender.method->counter(&device, &surface, *contender.settings);
      prepared.counter = std::move(counter.evaluator);
      prepared.flops_a_count = counter.flops_a_count;
    } catch (const UsageError& error) {
      prepared.refused = error.what();
    }
    all.push_back(std::move(prepared));
  }
  return all;
}

}  // namespace mica::host::bench
