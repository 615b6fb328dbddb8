#pragma once

#include <Eigen/Core>

namespace mica::host {

/// X of A X = B by LDL^T; in one source, since Eigen's templates take seconds to compile in each.
/// @param symmetric A, n x n, positive semidefinite. @param right B, n x m.
Eigen::MatrixXd solve_normal_equations(const Eigen::MatrixXd& symmetric, const Eigen::MatrixXd& right);

}  // namespace mica::host
