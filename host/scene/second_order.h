#pragma once

#include <Eigen/Core>

namespace mica::host {

/// What the first order of a pixel leaves out, in coordinates y in which its Gaussian is round: by u = y +
/// of_uv(y, y) / 2 places of the map lie aside, in standard deviations of the footprint, and h(u) = h0 + H u
/// + of_h(y, y) / 2 half vectors miss. All matrices are symmetric.
struct SecondOrder {
  Eigen::Matrix2d of_uv[2], of_h[2];
  Eigen::Matrix2d of_log_weight;  ///< of the light's factor
};

/// Where a footprint lies best. To the first order its weight is exp(a y), and uv bend by q: it is G(y) (1 +
/// a y + y' q(y, y) / 2 - div q y), which is no Gaussian any more; of all that move it this one is nearest in
/// the mean square over the plane, where glints lie anywhere.
/// @param log_weight_slope a, per standard deviation.
Eigen::Vector2d best_shift(const SecondOrder& bend, const Eigen::Vector2d& log_weight_slope);

/// The square of the relative L2 that is left, over glints anywhere, as the trace of a matrix that tells it
/// by direction. Of a footprint moved by `best_shift` that is T(y, y, y), the symmetric part of y' q(y, y) /
/// 2 less what is linear in it: 3/4 |T|^2 over the square of a Gaussian. Half vectors miss by of_h(y, y) / 2
/// less its mean, in lobes, of which the square of two Gaussians' difference has half: |of_h|^2 / 16. The
/// light's factor has twice that.
/// @param lobe_cov on the disk.
Eigen::Matrix2d left_out(const SecondOrder& bend, const Eigen::Matrix2d& lobe_cov);

}  // namespace mica::host
