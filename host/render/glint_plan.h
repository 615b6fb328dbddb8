#pragma once

#include "host/methods/grid/grid_evaluator.h"
#include "host/render/plan.h"

namespace mica::host {

/// What the kernel has to do for a material of glints, and nothing else.
GridFeatures glint_features(const GlintsDescription& glints);

/// Index of the evaluator of one of `materials`, which is of glints; planned now if it is the first to need
/// it. It has no surface and no memory, only a kernel; materials with the same kernel and colours share it,
/// unless light from all around needs a BRDF of each. Throws UsageError for triplanar or textured glints in
/// such light.
int plan_glints(const std::vector<MaterialDescription>& materials, const MaterialDescription& material,
                Plan* plan);

/// The evaluator of a material of glints. @param device must outlive it.
std::unique_ptr<GridEvaluator> make_glint_evaluator(const MaterialDescription& material, Device& device);

}  // namespace mica::host
