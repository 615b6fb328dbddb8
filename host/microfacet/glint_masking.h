#pragma once

#include <Eigen/Core>

#include "host/base/glints_description.h"

namespace mica::host {

/// Masking and shadowing G(o, i) of a glint with the normal h, half way between them: Smith's,
/// height-correlated, for the smooth distribution [Heitz14 Eqs. 72, 86, 99], or that of V-cavities [Che19 Eq.
/// 4].
/// @param alpha roughness along x and y; @param to_eye, to_light unit, in the tangent frame, above its
/// horizon. @return [0, 1].
double glint_masking(Distribution distribution, GlintsDescription::Masking masking,
                     const Eigen::Vector2d& alpha, const Eigen::Vector3d& to_eye,
                     const Eigen::Vector3d& to_light);

}  // namespace mica::host
