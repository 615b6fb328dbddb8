#include "host/engine/glint_plan.h"

#include <fmt/format.h>

#include <algorithm>

#include "host/base/error.h"

namespace mica {
namespace {

constexpr std::size_t kQueriesABatch = std::size_t{1} << 17;

}  // namespace

GridFeatures glint_features(const GlintsDescription& glints) {
  GridFeatures features;
  features.colors = std::max<int>(1, static_cast<int>(glints.colors.size()));
  features.roulette = glints.mapping == GlintsDescription::Mapping::triplanar ||
                      !glints.textures.density.empty() || !glints.textures.stretch.empty();
  return features;
}

int plan_glints(const std::vector<MaterialDescription>& materials, const MaterialDescription& material,
                Plan* plan) {
  if (plan->gathers_light)
    throw UsageError(fmt::format(
        "material.{}.ndf: found \"grid\" in light from all around; expected an evaluator on a surface there",
        material.name));
  std::vector<PlannedEvaluator>* planned = &plan->evaluators;
  const std::string kernel =
      "grid.cl " + grid_kernel_options(material.glints->distribution, glint_features(*material.glints));
  auto found = std::find_if(planned->begin(), planned->end(), [&](const PlannedEvaluator& p) {
    return p.glints_material >= 0 && p.kernel == kernel &&
           materials[static_cast<std::size_t>(p.glints_material)].glints->colors == material.glints->colors;
  });
  if (found == planned->end()) {
    PlannedEvaluator evaluator;
    evaluator.evaluator = "grid";
    evaluator.surface_index = -1;
    evaluator.asks_densities = true;
    evaluator.glints_material = static_cast<int>(&material - materials.data());
    evaluator.kernel = kernel;
    found = planned->insert(planned->end(), evaluator);
  }
  found->materials.push_back(material.name);
  return static_cast<int>(found - planned->begin());
}

std::unique_ptr<GridEvaluator> make_glint_evaluator(const MaterialDescription& material, Device& device) {
  GlintGrid grid;
  grid.distribution = material.glints->distribution;
  return std::make_unique<GridEvaluator>(device, grid, std::nullopt, kQueriesABatch,
                                         glint_features(*material.glints));
}

}  // namespace mica
