#include "host/base/symmetric_matrix.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace mica::host {

PrincipalAxes principal_axes(const Eigen::Matrix2d& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(symmetric);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

PrincipalAxes principal_axes_directly(const Eigen::Matrix2d& symmetric) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver;
  solver.computeDirect(symmetric);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

Eigen::Matrix2d cholesky_factor(const Eigen::Matrix2d& covariance) {
  return covariance.llt().matrixL();
}

}  // namespace mica::host
