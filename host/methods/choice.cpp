#include "host/methods/choice.h"

#include <fmt/format.h>

#include <cmath>

namespace mica::host {

std::string words(const AutoChoice& choice) {
  const std::string chosen =
      fmt::format("footprints of about {:.3g} texels{}, roughness from {:.3g}: {}",
                  std::exp2(choice.kind.size), choice.kind.first_order ? " with a first order" : "",
                  0.02 * std::exp2(0.5 * choice.kind.roughness), choice.evaluator);
  if (choice.samples == 0) return chosen + ", which promise it; not looked at";
  return fmt::format("{}; relative L2 {:.2g}, at most {:.2g} at 95% confidence by {} queries", chosen,
                     choice.relative_l2, choice.upper_bound, choice.samples);
}

}  // namespace mica::host
