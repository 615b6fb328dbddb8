#pragma once

#include <Eigen/Core>

#include "host/base/cavities.h"

namespace mica::host {

/// f_2+(o, i) max(i.g, 0) per steradian, which integrates to 1 over the hemisphere for every view above the
/// horizon. The specular lobe is a Gaussian of (i_x, i_y) about -(o_x, o_y), cut at the unit circle.
/// @param roughness of the facets: standard deviation on the disk.
double compensation(Compensation kind, const Eigen::Vector3d& view, const Eigen::Vector3d& light,
                    double roughness);

/// Standard deviation of (i_x, i_y) in the specular lobe: twice that of the half vector.
double specular_lobe_sigma(double roughness);

}  // namespace mica::host
