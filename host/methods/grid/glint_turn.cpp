#include "host/methods/grid/glint_turn.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "host/base/constants.h"
#include "host/base/symmetric_matrix.h"

namespace mica::host {
namespace {

/// A half vector by the axes of the distribution.
struct ScaledHalf {
  Eigen::Vector2d inverse_alpha, scaled;
  double cos2, slope2;  ///< squares of its cosine and of its slope over alpha

  ScaledHalf(const Eigen::Vector2d& half, const GlintPoint& glints)
      : inverse_alpha(1.0 / glints.alpha_x, 1.0 / glints.alpha_y),
        scaled(half.cwiseProduct(inverse_alpha)),
        cos2(std::max(1 - half.squaredNorm(), 1e-12)),
        slope2(scaled.squaredNorm() / cos2) {}
};

/// D of the smooth distribution, per area of the disk (s, t); 0 off it.
double smooth_density(const Eigen::Vector2d& half, const GlintPoint& glints) {
  if (half.squaredNorm() >= 1) return 0;
  const ScaledHalf at(half, glints);
  const double scale = at.inverse_alpha.prod() / (kPi * at.cos2 * at.cos2);
  if (glints.distribution == Distribution::beckmann) return scale * std::exp(-at.slope2);
  return scale / ((1 + at.slope2) * (1 + at.slope2));
}

/// The Jacobian of T(h) = (1/2, 1/2) + g(h) scaled / 2: kernels/grid/glint_maps.h has g.
Eigen::Matrix2d map_jacobian(const Eigen::Vector2d& half, const GlintPoint& glints) {
  const ScaledHalf at(half, glints);
  const Eigen::Vector2d by_half = at.scaled.cwiseProduct(at.inverse_alpha);
  double stretch = 0;        // g
  Eigen::Vector2d gradient;  // of g
  if (glints.distribution == Distribution::beckmann) {
    const double z = at.slope2, mean = z < 1e-4 ? 1 - z / 2 : -std::expm1(-z) / z;  // g^2 = mean / cos2
    const double by_slope2 = z < 1e-4 ? -0.5 + z / 3 : (std::exp(-z) - mean) / z;
    stretch = std::sqrt(mean / at.cos2);
    gradient = (by_slope2 * (by_half + z * half) + mean * half) / (at.cos2 * at.cos2 * stretch);
  } else {
    stretch = 1 / std::sqrt(at.cos2 * (1 + at.slope2));
    gradient = -stretch * stretch * stretch * (by_half - half);
  }
  Eigen::Matrix2d jacobian = at.scaled * gradient.transpose();
  jacobian.diagonal() += stretch * at.inverse_alpha;
  return 0.5 * jacobian;
}

/// Mean of the smooth distribution over the footprint, exact to the fifth order of the turn: by the 3x3
/// points of Gauss and Hermite along the columns of the root of the half vector's covariance, which changes
/// smoothly with it.
double mean_density(const Query& query, const GlintPoint& glints) {
  const Eigen::Matrix2d& turn = query.half_vector_turn;
  Eigen::Matrix2d steps = turn * query.footprint.cov_uv * turn.transpose();
  const double root = std::sqrt(std::max(steps.determinant(), 0.0)), scale = steps.trace() + 2 * root;
  if (!(scale > 0)) return smooth_density(query.half_vector, glints);
  steps.diagonal().array() += root;
  steps *= std::sqrt(3 / scale);
  double sum = 0;
  for (int i = -1; i <= 1; ++i)
    for (int j = -1; j <= 1; ++j)
      sum += (i == 0 ? 4 : 1) * (j == 0 ? 4 : 1) / 36.0 *
             smooth_density(query.half_vector + steps * Eigen::Vector2d(i, j), glints);
  return sum;
}

}  // namespace

GlintTurn glint_turn(const Query& query, const GlintPoint& glints, const Eigen::Matrix2d& axes) {
  GlintTurn result;
  const double density = smooth_density(query.half_vector, glints);
  const double jacobian = std::sqrt(std::max(kPi / 4 * density, 1e-20)),  // how lengths change, Eq. 3
      stretch = std::sqrt(double{glints.stretch});
  const Eigen::DiagonalMatrix<double, 2> to_square(jacobian / stretch, jacobian * stretch);
  result.lobe = to_square * cholesky_factor(lobe_covariance(query));
  result.turn =
      result.lobe.inverse() * map_jacobian(query.half_vector, glints) * query.half_vector_turn * axes;
  const Eigen::Matrix2d factor = result.lobe * result.turn;
  const Eigen::Matrix2d spread = result.lobe * result.lobe.transpose() + factor * factor.transpose();
  result.spread = spread.diagonal().cwiseSqrt();
  result.correlation = std::clamp(spread(0, 1) / result.spread.prod(), -1.0, 1.0);
  if (density > 0) result.smooth_density = mean_density(query, glints);
  return result;
}

}  // namespace mica::host
