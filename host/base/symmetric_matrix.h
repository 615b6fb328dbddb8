#pragma once

#include <Eigen/Core>

namespace mica::host {

// Decompositions of symmetric 2x2 matrices. Eigen's templates behind them take seconds to compile, in each
// source that names them; so one source does.

struct PrincipalAxes {
  Eigen::Vector2d eigenvalues;   ///< the smaller one first
  Eigen::Matrix2d eigenvectors;  ///< unit, in columns
};

/// By steps of QR until nothing is left beside the diagonal; looks at the lower triangle only.
PrincipalAxes principal_axes(const Eigen::Matrix2d& symmetric);

/// In closed form: quicker, and less precise where the eigenvalues differ much.
PrincipalAxes principal_axes_directly(const Eigen::Matrix2d& symmetric);

/// The lower triangular L with L L^T = the matrix, which must be positive definite [Cholesky].
Eigen::Matrix2d cholesky_factor(const Eigen::Matrix2d& covariance);

}  // namespace mica::host
