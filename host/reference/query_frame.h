#pragma once

#include <Eigen/Core>

#include "host/base/query.h"
#include "host/reference/cell_map.h"
#include "host/surface/surface.h"

namespace mica::host::reference {

using Whitened =
    Eigen::Vector4d;  ///< position and normal in units of their standard deviations, relative to the query

/// One query seen from the surface: the affine map that turns G_p(u) G_r(n(u) - h - H (u - c)) into
/// exp(-|w|^2 / 2), w in R^4.
class QueryFrame {
 public:
  /// @param negligible relative size of the ripple up to which a wide footprint counts as covering the map
  /// evenly. One over which the half vector turns never does. Throws UsageError if a number is not finite, a
  /// covariance is not positive definite or the roughness is not > 0.
  QueryFrame(const Surface& surface, const Query& query, double negligible);

  /// Components 0 and 1 of w at a position in texels.
  Eigen::Vector2d whiten_position(const Eigen::Vector2d& position_texels) const;
  /// Components 2 and 3 of w at a normal on the disk and a position that whitens to components 0 and 1.
  Eigen::Vector2d whiten_normal(const Eigen::Vector2d& normal,
                                const Eigen::Vector2d& whitened_position = Eigen::Vector2d::Zero()) const {
    return whiten_lobe_ * (normal - half_vector_) - whitened_turn_ * whitened_position;
  }
  /// Lower bound of the squared length of components 2 and 3 where normals lie in a box and positions in the
  /// hull of `corners`, whitened.
  double lobe_distance_squared(const NormalBox& box, const Eigen::Vector2d* corners, int count) const;

  /// True where the footprint spans so many periods that its sum over them is constant: then one period is
  /// enough, and positions whiten to 0.
  bool covers_evenly() const { return covers_evenly_; }
  const Eigen::Vector2d& mean_texels() const { return mean_texels_; }
  const Eigen::Matrix2d& cov_texels() const { return cov_texels_; }
  /// Area over which the footprint spreads, in texels^2.
  double effective_area() const { return effective_area_; }
  /// D = scale * integral of exp(-|w|^2 / 2) du, u in texels.
  double scale() const { return scale_; }
  /// Relative error of D from the rounding of w itself, where |w| <= 8.
  double rounding() const { return rounding_; }

 private:
  double set_lobe(const Query& query);

  Eigen::Vector2d mean_texels_, half_vector_;
  Eigen::Matrix2d cov_texels_;
  Eigen::Matrix2d whiten_lobe_;           ///< inverse of the Cholesky factor of the lobe's covariance
  Eigen::Matrix2d whitened_turn_;         ///< change of the whitened half vector a unit of whitened position
  double inverse_x_, shear_, inverse_y_;  ///< entries of the inverse of cov_texels' Cholesky factor
  bool covers_evenly_;
  double effective_area_, scale_, rounding_;
};

}  // namespace mica::host::reference
