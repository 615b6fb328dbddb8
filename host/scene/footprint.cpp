#include "host/scene/footprint.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace mica::host {

Eigen::Matrix<double, 3, 2> position_differentials(const CameraRay& ray, const Hit& hit) {
  // Bounds what follows; such a footprint is shortened later.
  const double least = 1e-9 * ray.direction.norm();
  double cosine = hit.face_normal.dot(ray.direction);
  if (std::abs(cosine) < least) cosine = std::copysign(least, cosine);

  Eigen::Matrix<double, 3, 2> dp;  // [Igehy99] Eq. 10 to 12 for a fixed origin
  dp.col(0) = hit.t * (ray.ddx - hit.face_normal.dot(ray.ddx) / cosine * ray.direction);
  dp.col(1) = hit.t * (ray.ddy - hit.face_normal.dot(ray.ddy) / cosine * ray.direction);
  return dp;
}

Eigen::Matrix2d uv_differentials(const CameraRay& ray, const Hit& hit) {
  Eigen::Matrix<double, 3, 2> dpduv;
  dpduv << hit.dpdu, hit.dpdv;
  const Eigen::Matrix2d metric = dpduv.transpose() * dpduv;
  if (metric.determinant() <= 1e-24 * metric.trace() * metric.trace()) return Eigen::Matrix2d::Zero();
  return metric.inverse() * (dpduv.transpose() * position_differentials(ray, hit));
}

Eigen::Matrix2d footprint_covariance(const Eigen::Matrix2d& duv, double sigma_pixels) {
  constexpr double max_condition = 1e4, min_variance = 1e-14;
  Eigen::Matrix2d covariance = sigma_pixels * sigma_pixels * duv * duv.transpose();
  covariance(1, 0) = covariance(0, 1);  // to the last bit
  const double cuu = covariance(0, 0), cuv = covariance(0, 1), cvv = covariance(1, 1);
  const double major = (cuu + cvv) / 2 + std::hypot((cuu - cvv) / 2, cuv);
  // By the determinant of duv: that of the covariance loses the minor axis of a long footprint to
  // cancellation.
  const double determinant = sigma_pixels * sigma_pixels * duv.determinant();
  const double minor = major > 0 ? determinant * determinant / major : 0;
  if (minor >= min_variance && major <= max_condition * minor) return covariance;

  const double bounded_minor = std::max(minor, min_variance);
  const double bounded_major = std::clamp(major, bounded_minor, max_condition * bounded_minor);
  Eigen::Vector2d axis = cuu > cvv ? Eigen::Vector2d(major - cvv, cuv) : Eigen::Vector2d(cuv, major - cuu);
  if (axis.squaredNorm() > 0) axis.normalize();
  const Eigen::Vector2d longer = (bounded_major - bounded_minor) * axis;
  const double across = longer.x() * axis.y();  // once: the other way around it would be rounded differently
  Eigen::Matrix2d bounded;
  bounded << bounded_minor + longer.x() * axis.x(), across, across, bounded_minor + longer.y() * axis.y();
  return bounded;
}

Eigen::Matrix2d turn_over(const Eigen::Matrix2d& duv, const Eigen::Matrix2d& dh, double sigma_pixels) {
  constexpr double max_condition = 50, most_turn = 0.25;
  if (!(std::abs(duv.determinant()) * max_condition > duv.squaredNorm()) ||
      !(sigma_pixels * dh.norm() < most_turn))
    return Eigen::Matrix2d::Zero();
  return dh * duv.inverse();
}

}  // namespace mica::host
