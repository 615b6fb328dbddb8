#include "host/render/error_estimates.h"

#include <tbb/parallel_for.h>

#include "host/methods/auto/auto_evaluator.h"
#include "host/verify/accuracy.h"

namespace mica::host {

std::vector<float> estimate_errors(const BuiltJob& built, const TracedRows& rows,
                                   const std::vector<float>& densities) {
  std::vector<float> errors(densities.size());
  tbb::parallel_for(std::size_t{0}, errors.size(), [&](std::size_t n) {
    const GlintQuery& glint = rows.queries[n];
    const auto evaluator = static_cast<std::size_t>(built.plan().evaluator_of_material[glint.material]);
    const auto* const chooser = dynamic_cast<const AutoEvaluator*>(&built.evaluator(evaluator));
    errors[n] = static_cast<float>(chooser != nullptr ? chooser->error_estimate(glint.query, densities[n])
                                                      : relative_bound(glint.query.roughness) * densities[n]);
  });
  return errors;
}

}  // namespace mica::host
