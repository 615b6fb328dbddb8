#pragma once

#include "host/base/query.h"
#include "host/methods/beckmanns/lobes.h"
#include "host/surface/description.h"
#include "kernels/types.h"

namespace mica::host {

/// What the queries of one mixture of Beckmann lobes have in common.
struct LobeGrid {
  device_types::mica_map_grid grid{};     ///< of elements
  float slope_unit = 0, spread_unit = 0;  ///< of its nodes
  Interpolation interpolation = Interpolation::bilinear;
  int elements = 1;  ///< a texel and axis
};

/// How the weights of a mixture's elements fall off about a footprint, in units of an element.
///
/// An element's lobe is that of the surface under its position kernel, so that elements weighted by a
/// Gaussian see the surface under that Gaussian and a kernel together. The weights' variance is therefore the
/// footprint's less the kernel's, along each axis, and no less than the kernel's, below which the elements'
/// sum would ripple. [Che18] Eq. 9 has the sum of both, and counts the kernel twice.
struct LobeWeights {
  std::int32_t mean_i = 0, mean_j = 0;  ///< whole elements of the grid
  float mean_x = 0, mean_y = 0;         ///< and the rest, in [0, 1)
  Eigen::Matrix2d axes;                 ///< columns: the footprint's, unit
  Eigen::Vector2d sigma;                ///< standard deviations along them
  double sum = 1;                       ///< of the weights of all elements

  Eigen::Matrix2d covariance() const { return axes * sigma.cwiseAbs2().asDiagonal() * axes.transpose(); }
};
LobeWeights lobe_weights(const Footprint& footprint, const LobeGrid& lobes);

/// The slope of a half vector, and what a density of slopes there is multiplied with to be one on the disk:
/// 1 / cos^4 [Che18 Eq. 2], or 0 at the horizon and beyond.
struct HalfSlope {
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  double to_density = 0;
};
HalfSlope to_half_slope(const Eigen::Vector2d& half_vector);

/// The query in the kernel's form.
/// @param weights of its footprint.
/// @param cutoff largest sum of squared distances that counts, see `cutoff_for`.
device_types::mica_lobe_query to_lobe_query(const Query& query, const LobeWeights& weights,
                                            const LobeGrid& lobes, double cutoff);

}  // namespace mica::host
