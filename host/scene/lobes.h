#pragma once

#include <optional>

#include "host/scene/coat.h"
#include "host/scene/description.h"
#include "host/scene/shading.h"

namespace mica::host {

/// What a material sends towards the eye of the light from one direction, by unit irradiance of the light.
struct LobesSeen {
  Color smooth;                 ///< the sum of all lobes that need no P-NDF
  Eigen::Vector3d half_vector;  ///< at which the P-NDF is asked for; unit, below the coat where there is one
  double roughness;             ///< roughness of that query, with the light's extent
  Color glint_weight;           ///< that its density is multiplied with
};

/// @param masking_alpha see glint_weight; @param n towards the eye; @param to_eye unit.
LobesSeen see_lobes(const MaterialDescription& material, const std::optional<CoatInterface>& coat,
                    double masking_alpha, const Eigen::Vector3d& n, const Eigen::Vector3d& to_eye,
                    const Illumination& incident);

}  // namespace mica::host
