#pragma once

#include <Eigen/Core>

#include "host/base/glints.h"
#include "host/base/query.h"

namespace mica::host {

/// What a query of glints has besides where its half vector turns over the footprint or its lobe is not
/// round; see MICA_GLINT_LOBE_A and those after it. Lengths are those of the unit square.
struct GlintTurn {
  Eigen::Matrix2d lobe;       ///< Cholesky factor of the lobe's covariance
  Eigen::Matrix2d turn;       ///< in lobes, by the footprint's axes: lobe^-1 J_T H axes
  Eigen::Vector2d spread;     ///< standard deviations of lobe and turn together
  double correlation = 0;     ///< of these
  double smooth_density = 0;  ///< mean over the footprint, per area of the disk of half vectors
};

/// @param axes of the footprint: columns of one standard deviation each, in uv.
///
/// The turn goes through the true Jacobian of T, so that a glint is seen from where a constant half vector
/// would see it, and not through the root of its determinant, as lobes do [Kem25 Algorithm 1]; areas are kept
/// by both.
GlintTurn glint_turn(const Query& query, const GlintPoint& glints, const Eigen::Matrix2d& axes);

}  // namespace mica::host
