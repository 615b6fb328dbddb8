#include "host/measure/contenders.h"

#include <fmt/format.h>

#include <algorithm>

#include "host/methods/gaussians/mixture_evaluator.h"
#include "host/methods/make_evaluator.h"
#include "host/methods/triangles/triangle_evaluator.h"
#include "mica/error.h"

namespace mica::host::bench {
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

namespace {

void add_counter(Device& device, const Surface& surface, Prepared* prepared) {
  if (prepared->contender.evaluator == "triangles") {
    TriangleSettings settings;
    settings.count_flops = true;
    prepared->counter = std::make_unique<TriangleEvaluator>(device, surface, settings);
    prepared->flops_a_count = 1;
  } else if (prepared->contender.evaluator == "gaussians") {
    MixtureSettings settings;
    settings.elements = prepared->contender.elements;
    settings.count_elements = true;
    prepared->counter = std::make_unique<GaussianEvaluator>(device, surface, settings);
    prepared->flops_a_count = kFlopsAnElement;
  }
}

}  // namespace

std::vector<Prepared> prepare(const std::vector<Contender>& contenders, Device& device,
                              const Surface& surface) {
  std::vector<Prepared> all;
  for (const Contender& contender : contenders) {
    Prepared prepared;
    prepared.contender = contender;
    try {
      prepared.evaluator = make_evaluator(contender.evaluator, device, surface, contender.elements);
      add_counter(device, surface, &prepared);
    } catch (const UsageError& error) {
      prepared.refused = error.what();
    }
    all.push_back(std::move(prepared));
  }
  return all;
}

}  // namespace mica::host::bench
