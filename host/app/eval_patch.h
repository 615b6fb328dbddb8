#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/app/map_options.h"
#include "host/scene/glints_description.h"

namespace mica::host::app {

/// What `mica eval` was asked for about a patch BRDF.
struct PatchEvaluation {
  MapOptions map;
  std::string quantity, ndf, queries, output, json;  ///< quantity: one of patch_quantities()
  std::string masking = "exact", part = "all";
  std::optional<double> roughness;
  std::uint64_t seed = 1;
  int device = 0, elements = 1;
  std::string compensation = "diffuse", energy = "exact";
  std::optional<GlintsDescription> glints = {};  ///< of `grid`, which needs no map
};

/// "brdf", "energy" and "sample".
const std::vector<std::string>& patch_quantities();

/// Runs it; returns the exit code, throws mica::Error.
int evaluate_patches(const PatchEvaluation& options);

}  // namespace mica::host::app
