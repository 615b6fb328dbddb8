#pragma once

#include <Eigen/Core>

#include "host/base/query.h"
#include "host/surface/surface.h"

namespace mica::host {

/// A footprint by its axes, in the texels of a surface.
/// @param angle radians from +u to the major axis, in texel space.
Footprint make_footprint(const Surface& surface, const Eigen::Vector2d& mean_uv, double sigma_major_texels,
                         double sigma_minor_texels, double angle);

}  // namespace mica::host
