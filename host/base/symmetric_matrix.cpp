#include "host/base/symmetric_matrix.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace mica::host {

PrincipalAxes principal_axes(const Eigen::Matrix2d& symmetric) {
  // As Eigen's compute(), less the reflections that make a matrix tridiagonal: of this size it is.
  const Eigen::Vector3d entries(symmetric(0, 0), symmetric(1, 1), symmetric(1, 0));
  const double largest = entries.cwiseAbs().maxCoeff(), scale = largest == 0 ? 1 : largest;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver;
  solver.computeFromTridiagonal(entries.head<2>() / scale, entries.tail<1>() / scale);
  return {solver.eigenvalues() * scale, solver.eigenvectors()};
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
