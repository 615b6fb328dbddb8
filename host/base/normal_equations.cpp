#include "host/base/normal_equations.h"

#include <Eigen/Cholesky>

namespace mica::host {

Eigen::MatrixXd solve_normal_equations(const Eigen::MatrixXd& symmetric, const Eigen::MatrixXd& right) {
  return symmetric.ldlt().solve(right);
}

}  // namespace mica::host
