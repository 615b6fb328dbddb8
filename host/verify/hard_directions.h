#pragma once

#include <functional>
#include <string>
#include <vector>

#include "host/verify/run_hard_case.h"

namespace mica::host {

/// Directions that break BRDFs. Both are unit, or would be but for rounding.
struct HardDirections {
  std::string name, why;
  std::function<Eigen::Vector3d(std::uint64_t n)> view, light;
  bool dark = false;  ///< nothing is seen: all answers have to be zero
};
const std::vector<HardDirections>& hard_directions();

/// Asks every patch BRDF of the registry, with every masking, for values, energy and draws: on a noisy map,
/// on flakes and on normals near the rim, under footprints of 0.3 to 3 texels. Answers have to be finite and
/// not negative, a patch may not scatter more than it receives, a draw's direction has to be unit and its
/// weight no larger than a hundred, and where nothing is seen there has to be nothing.
/// @param queries of each kind, surface and BRDF.
std::vector<HardResult> run_hard_directions(const HardDirections& directions, Device& device, int queries,
                                            const MethodRegistry& methods = MethodRegistry::builtin());

}  // namespace mica::host
