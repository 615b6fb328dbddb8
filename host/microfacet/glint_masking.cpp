#include "host/microfacet/glint_masking.h"

#include <algorithm>
#include <cmath>

#include "host/microfacet/masking.h"

namespace mica::host {
namespace {

/// Lambda(omega) of a distribution that is stretched by alpha. [Heitz14] Eq. 80
double smith_lambda(Distribution distribution, const Eigen::Vector2d& alpha, const Eigen::Vector3d& omega) {
  const double across = omega.head<2>().cwiseProduct(alpha).norm(), sine = omega.head<2>().norm();
  if (!(sine > 0)) return 0;
  if (distribution == Distribution::beckmann) return beckmann_lambda(omega.z(), across / sine);
  return (std::hypot(1.0, across / omega.z()) - 1) / 2;  // [Heitz14] Eq. 72
}

double cavity_masking(const Eigen::Vector3d& to_eye, const Eigen::Vector3d& to_light) {
  const Eigen::Vector3d half = (to_eye + to_light).normalized();
  const double both = 2 * half.z() / to_eye.dot(half);  // o.h = i.h
  return std::min({1.0, both * to_eye.z(), both * to_light.z()});
}

}  // namespace

double glint_masking(Distribution distribution, GlintsDescription::Masking masking,
                     const Eigen::Vector2d& alpha, const Eigen::Vector3d& to_eye,
                     const Eigen::Vector3d& to_light) {
  if (masking == GlintsDescription::Masking::cavity) return cavity_masking(to_eye, to_light);
  return 1 / (1 + smith_lambda(distribution, alpha, to_eye) + smith_lambda(distribution, alpha, to_light));
}

}  // namespace mica::host
