#include "host/scene/second_order.h"

#include <Eigen/LU>

namespace mica::host {

Eigen::Vector2d best_shift(const SecondOrder& bend, const Eigen::Vector2d& log_weight_slope) {
  const Eigen::Matrix2d &u = bend.of_uv[0], &v = bend.of_uv[1];
  const Eigen::Vector2d divergence = u.row(0).transpose() + v.row(1).transpose();
  const Eigen::Vector2d laplacian(u.trace(), v.trace());
  return log_weight_slope - 0.5 * divergence + 0.25 * laplacian;
}

Eigen::Matrix2d left_out(const SecondOrder& bend, const Eigen::Matrix2d& lobe_cov) {
  const Eigen::Matrix2d &u = bend.of_uv[0], &v = bend.of_uv[1];
  // T_uuu, T_uuv, T_uvv, T_vvv
  const double t[4] = {u(0, 0) / 2, (2 * u(0, 1) + v(0, 0)) / 6, (u(1, 1) + 2 * v(0, 1)) / 6, v(1, 1) / 2};
  Eigen::Matrix2d aside;
  aside(0, 0) = t[0] * t[0] + 2 * t[1] * t[1] + t[2] * t[2];
  aside(0, 1) = aside(1, 0) = t[0] * t[1] + 2 * t[1] * t[2] + t[2] * t[3];
  aside(1, 1) = t[1] * t[1] + 2 * t[2] * t[2] + t[3] * t[3];
  const Eigen::Matrix2d in_lobes = lobe_cov.inverse();
  Eigen::Matrix2d missed = Eigen::Matrix2d::Zero();
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j) missed += in_lobes(i, j) * bend.of_h[i] * bend.of_h[j];
  return 0.75 * aside + (missed + missed.transpose()) / 32 + bend.of_log_weight * bend.of_log_weight / 8;
}

}  // namespace mica::host
