#include "host/microfacet/visible_normals.h"

#include <algorithm>
#include <cmath>

#include "host/base/constants.h"
#include "host/base/symmetric_matrix.h"

namespace mica::host {
VisibleNormals::VisibleNormals(const Eigen::Matrix2d& slope_moments) {
  const PrincipalAxes axes = principal_axes_directly(slope_moments);
  axes_ = axes.eigenvectors;
  // A Beckmann alpha is sqrt(2) standard deviations of the slope.
  alphas_ = (2 * axes.eigenvalues).cwiseMax(1e-12).cwiseSqrt();
}

Eigen::Vector3d VisibleNormals::sample(const Eigen::Vector3d& view, const Eigen::Vector2d& uniform) const {
  const Eigen::Vector2d across = alphas_.cwiseProduct(axes_.transpose() * view.head<2>());
  const Eigen::Vector3d stretched = Eigen::Vector3d(across.x(), across.y(), view.z()).normalized();
  const double azimuth = 2 * kPi * uniform.x();
  const double z = (1 - uniform.y()) * (1 + stretched.z()) - stretched.z();
  const double radius = std::sqrt(std::max(0.0, (1 - z) * (1 + z)));
  const Eigen::Vector3d half =
      stretched + Eigen::Vector3d(radius * std::cos(azimuth), radius * std::sin(azimuth), z);
  const Eigen::Vector2d flat = axes_ * alphas_.cwiseProduct(half.head<2>());
  return Eigen::Vector3d(flat.x(), flat.y(), std::max(half.z(), 0.0)).normalized();
}

double VisibleNormals::pdf(const Eigen::Vector3d& view, const Eigen::Vector3d& half) const {
  const Eigen::Vector2d o = alphas_.cwiseProduct(axes_.transpose() * view.head<2>());
  const Eigen::Vector2d h = (axes_.transpose() * half.head<2>()).cwiseQuotient(alphas_);
  const double length2 = h.squaredNorm() + half.z() * half.z();
  const double D = 1 / (kPi * alphas_.prod() * length2 * length2);
  // G1(o) / o.z, finite on the horizon.
  const double G1 = 2 / (view.z() + std::sqrt(view.z() * view.z() + o.squaredNorm()));
  return G1 * D / 4;
}

}  // namespace mica::host
