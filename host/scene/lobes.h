#pragma once

#include "host/scene/layered_material.h"
#include "host/scene/shading.h"

namespace mica::host {

/// What a material sends towards the eye of the light from one direction, by unit irradiance of the light.
struct LobesSeen {
  Color smooth;                      ///< the sum of all lobes that need no P-NDF
  Eigen::Vector3d to_eye, to_light;  ///< unit, below the coat where there is one
  Eigen::Vector3d half_vector;       ///< of these: at which the P-NDF is asked for
  double roughness;                  ///< roughness of that query, with the light's extent
  Eigen::Matrix3d half_vector_cov;   ///< by the light's extent alone
  Color mirrored;                    ///< Fresnel's factor of the base, and what the coat leaves of it
  Color glint_weight;                ///< that and Smith's masking: what the P-NDF is multiplied with
};

/// @param n towards the eye; @param to_eye unit.
LobesSeen see_lobes(const LayeredMaterial& layers, const Eigen::Vector3d& n, const Eigen::Vector3d& to_eye,
                    const Illumination& incident);

}  // namespace mica::host
