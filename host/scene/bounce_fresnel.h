#pragma once

#include <Eigen/Core>

#include "host/scene/layered_material.h"

namespace mica::host {

/// What the two parts of a patch BRDF are multiplied with: light that bounced once takes Fresnel's factor at
/// the half vector, light that bounced more often that of the view on the geometric normal, [Che19] Eq. 11.
/// Towards grazing views that is more than the base mirrors, and what it mirrors more a diffuse lobe cannot
/// get: over one it is no more than that.
struct BounceFresnel {
  /// @param view, light unit, in the tangent frame, in the coat.
  BounceFresnel(const LayeredMaterial& layers, const Eigen::Vector3d& view, const Eigen::Vector3d& light);
  Color single, multiple;
};

}  // namespace mica::host
