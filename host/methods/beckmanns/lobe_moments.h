#pragma once

#include <Eigen/Core>
#include <vector>

#include "host/methods/beckmanns/lobes.h"
#include "host/surface/surface.h"

namespace mica::host {

/// E[x], E[y], E[x^2], E[xy], E[y^2] of slopes.
using SlopeMoments = Eigen::Matrix<double, 5, 1>;

/// Moments of the slopes under the position kernels of elements [first_i, first_i + count) x [first_j,
/// first_j + count), row by row. [Che18] Eq. 6, by Gauss points a cell with weights that integrate the kernel
/// times any quadratic exactly.
/// @param elements a texel and axis.
std::vector<SlopeMoments> slope_moments(const Surface& surface, int elements, int first_i, int first_j,
                                        int count);

/// The lobe with these moments.
Lobe to_lobe(const SlopeMoments& moments);

}  // namespace mica::host
