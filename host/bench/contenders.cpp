#include "host/bench/contenders.h"

#include <fmt/format.h>

#include <algorithm>

#include "host/engine/make_evaluator.h"
#include "host/engine/mixture_evaluator.h"
#include "host/engine/triangle_evaluator.h"

namespace mica::bench {
namespace {

constexpr double kFlopsAnElement = 105;  // of slice_elements in gaussians.cl and its share of the leaf

bool has_elements(const std::string& evaluator) {
  return evaluator == "gaussians" || evaluator == "beckmanns";
}

}  // namespace

std::vector<Contender> contenders(const std::vector<int>& elements) {
  std::vector<Contender> all;
  for (const std::string& name : evaluator_names()) {
    if (!has_elements(name)) {
      all.push_back({name, 1, name, ""});
      continue;
    }
    for (const int count : elements)
      all.push_back(
          {name, count, fmt::format("{}, {} a texel and axis", name, count), fmt::format("{}", count)});
  }
  return all;
}

std::unique_ptr<Evaluator> make(const Contender& contender, Device& device, const Surface& surface) {
  return make_evaluator(contender.evaluator, device, surface, contender.elements);
}

Counter make_counter(const Contender& contender, Device& device, const Surface& surface) {
  Counter counter;
  if (contender.evaluator == "triangles") {
    TriangleSettings settings;
    settings.count_flops = true;
    counter.evaluator = std::make_unique<TriangleEvaluator>(device, surface, settings);
    counter.flops_a_count = 1;
  } else if (contender.evaluator == "gaussians") {
    MixtureSettings settings;
    settings.elements = contender.elements;
    settings.count_elements = true;
    counter.evaluator = std::make_unique<GaussianEvaluator>(device, surface, settings);
    counter.flops_a_count = kFlopsAnElement;
  }
  return counter;
}

}  // namespace mica::bench
