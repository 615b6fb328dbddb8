#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "host/app/device_option.h"
#include "host/app/eval_output.h"
#include "host/app/map_options.h"
#include "host/app/method_options.h"
#include "host/surface/surface.h"

namespace mica::host::app {

/// What `mica eval` is about: a map, which has to outlive its evaluator, or glints without one.
struct EvalSubject {
  std::optional<Surface> surface;
  nlohmann::json description;

  const Surface* map() const { return surface ? &*surface : nullptr; }
};
EvalSubject load_subject(const MapOptions& map, const MethodOptions& method, const MethodSettings& settings);

/// What `mica eval` was asked for about a patch BRDF.
struct PatchEvaluation {
  MapOptions map;
  MethodOptions method;
  EvalOutput output;
  std::string quantity, queries, json;  ///< quantity: one of patch_quantities()
  std::string part = "all";
  std::optional<double> roughness;
  DeviceOption device;
};

/// "brdf", "energy" and "sample".
const std::vector<std::string>& patch_quantities();

/// Runs it; returns the exit code, throws mica::Error.
int evaluate_patches(const PatchEvaluation& options);

}  // namespace mica::host::app
