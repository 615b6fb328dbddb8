#pragma once

#include "host/scene/description.h"

namespace mica::host {

/// Unpolarised reflectance of a smooth boundary towards a medium of relative index `ior`, seen from outside.
/// @param cos_i cosine of the angle of incidence, [0, 1]. @return [0, 1].
double dielectric_reflectance(double cos_i, double ior);

/// Unpolarised reflectance of a conductor of relative complex index eta + i k. @return [0, 1].
double conductor_reflectance(double cos_i, double eta, double k);

/// Reflectance of each channel.
Color reflectance(const Fresnel& fresnel, double cos_i);

/// The same boundary towards its medium from one of index `ior` in place of air. Schlick's colour is that
/// seen from whatever lies above.
Fresnel below(const Fresnel& fresnel, double ior);

}  // namespace mica::host
