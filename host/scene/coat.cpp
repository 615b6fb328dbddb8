#include "host/scene/coat.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "host/base/constants.h"
#include "host/microfacet/circle_share.h"
#include "host/microfacet/masking.h"
#include "host/scene/fresnel.h"

namespace mica::host {
namespace {

/// Axes of the plane of incidence, right-handed about a direction in it: in the plane, and across.
struct IncidenceAxes {
  Eigen::Vector3d across;

  IncidenceAxes(const Eigen::Vector3d& n, const Eigen::Vector3d& to_eye)
      : across(n.cross(to_eye).norm() > 1e-9 ? n.cross(to_eye).normalized() : n.unitOrthogonal()) {}
  /// Of a small difference from `about`.
  Eigen::Vector2d operator()(const Eigen::Vector3d& difference, const Eigen::Vector3d& about) const {
    return {difference.dot(across.cross(about)), difference.dot(across)};
  }
};

}  // namespace

Eigen::Vector3d CoatInterface::refracted(const Eigen::Vector3d& direction, const Eigen::Vector3d& n) const {
  const double cosine = direction.dot(n);
  const Eigen::Vector3d sideways = (direction - cosine * n) / coat_.ior;
  return sideways + std::sqrt(std::max(0.0, 1 - sideways.squaredNorm())) * n;
}

double CoatInterface::crossing(double cos_o, double cos_i) const {
  return (1 - dielectric_reflectance(cos_o, coat_.ior)) * (1 - dielectric_reflectance(cos_i, coat_.ior)) /
         (coat_.ior * coat_.ior);
}

/// Facets have Gaussian slopes; a light with an extent is a disk about `to_light`. The eye sees the share of
/// the facets that mirror some of it: of a smooth coat all or none, and a rough one's where the half vector
/// is. Lengths are halves of those by which the mirror image of the eye turns: by as much as a facet turns in
/// the plane of incidence, and cos_d times as much across it.
double CoatInterface::reflection(const Eigen::Vector3d& n, const Eigen::Vector3d& to_eye,
                                 const Eigen::Vector3d& to_light, double light_variance) const {
  const double variance = coat_.roughness * coat_.roughness, cos_o = to_eye.dot(n);
  const Eigen::Vector3d half = (to_eye + to_light).normalized();
  if (half.dot(n) <= 0) return 0;
  const Eigen::Vector3d slope = half / half.dot(n) - n;
  // Slopes of the facets that mirror some of a disk: no steeper than facets are, on average.
  const double share = variance / (variance + light_variance);
  const double cos_m = 1 / std::sqrt(1 + share * share * slope.squaredNorm());
  const double cos_d = std::clamp(to_eye.dot(n + share * slope) * cos_m, 1e-6, 1.0);
  const double G = smith_masking_shadowing(cos_o, to_light.dot(n), std::sqrt(2.0) * coat_.roughness);
  const double scale =
      dielectric_reflectance(cos_d, coat_.ior) * G / (4 * cos_o * cos_m * cos_m * cos_m * cos_m);
  if (light_variance < 1e-3 * variance)  // beside which slopes alone are seen: [Yan14] Eq. 1
    return scale * std::exp(-slope.squaredNorm() / (2 * variance)) / (2 * kPi * variance);

  const IncidenceAxes axes(n, to_eye);
  const Eigen::Vector3d mirrored = 2 * cos_o * n - to_eye;
  const Eigen::Vector2d turned = axes(slope, n).cwiseProduct(Eigen::Vector2d(1, cos_d)),
                        missed = axes(to_light - mirrored, mirrored) / 2;
  const double radius = std::sqrt(light_variance);  // half of the disk's, of which the variance is a quarter
  return scale * cos_d / (kPi * light_variance) *
         share_in_unit_circle((share * turned + (1 - share) * missed) / radius,
                              coat_.roughness / radius * Eigen::Vector2d(1, cos_d));
}

}  // namespace mica::host
