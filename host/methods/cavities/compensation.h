#pragma once

#include <Eigen/Core>

#include "host/base/cavities.h"

namespace mica::host {

/// In roughnesses of the facets, how wide a mirror image of them is: their half vectors turn it by twice as
/// much.
constexpr double kMirrorWidth = 2;

/// f_2+(o, i) max(i.g, 0) per steradian, which integrates to 1 over the hemisphere for every view above the
/// horizon. The specular lobe is a Gaussian of (i_x, i_y) about -(o_x, o_y), cut at the unit circle.
/// @param roughness of the facets: standard deviation on the disk. @param width of the specular lobe, see
/// specular_lobe_sigma.
double compensation(Compensation kind, const Eigen::Vector3d& view, const Eigen::Vector3d& light,
                    double roughness, double width = kMirrorWidth);

/// Standard deviation of (i_x, i_y) in the specular lobe: `width` roughnesses, and no wider than the disk.
double specular_lobe_sigma(double roughness, double width);

}  // namespace mica::host
