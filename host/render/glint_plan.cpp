#include "host/render/glint_plan.h"

#include <fmt/format.h>

#include <algorithm>

#include "mica/error.h"

namespace mica::host {
namespace {}  // namespace

GridFeatures glint_features(const GlintsDescription& glints) {
  GridFeatures features;
  features.colors = std::max<int>(1, static_cast<int>(glints.colors.size()));
  features.roulette = glints.mapping == GlintsDescription::Mapping::triplanar ||
                      !glints.textures.density.empty() || !glints.textures.stretch.empty();
  return features;
}

namespace {

/// The BRDF of glints, which light from all around needs, knows one process and no place on the shape.
void check_gathers(const MaterialDescription& material) {
  const GlintsDescription& glints = *material.glints;
  if (glints.mapping == GlintsDescription::Mapping::triplanar)
    throw UsageError(fmt::format(
        "material.{}.mapping: found \"triplanar\" in light from all around; expected \"uv\" there",
        material.name));
  const GlintTextures& t = glints.textures;
  for (const std::string* file : {&t.density, &t.alpha, &t.microroughness, &t.stretch, &t.color})
    if (!file->empty())
      throw UsageError(fmt::format(
          "material.{}.textures: found \"{}\" in light from all around; expected no textures there",
          material.name, *file));
}

}  // namespace

int plan_glints(const std::vector<MaterialDescription>& materials, const MaterialDescription& material,
                Plan* plan) {
  if (plan->gathers_light) check_gathers(material);
  std::vector<PlannedEvaluator>* planned = &plan->evaluators;
  const Distribution distribution = material.glints->distribution;
  std::string kernel = "grid.cl " + grid_kernel_options(distribution, glint_features(*material.glints));
  if (plan->gathers_light) kernel += ", grid_brdf.cl " + grid_kernel_options(distribution, GridFeatures{});
  auto found = std::find_if(planned->begin(), planned->end(), [&](const PlannedEvaluator& p) {
    return !plan->gathers_light && p.glints_material >= 0 && p.kernel == kernel &&
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

}  // namespace mica::host
