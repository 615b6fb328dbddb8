#include "host/scene/coat.h"

#include <algorithm>
#include <cmath>

#include "host/base/constants.h"
#include "host/scene/fresnel.h"

namespace mica::host {
namespace {

/// Reflectance of the interface for diffuse light from outside: 2 int F(c) c dc, by the midpoint rule.
double outer_reflectance(double ior) {
  constexpr int steps = 4096;
  double sum = 0;
  for (int n = 0; n < steps; ++n) {
    const double cosine = (n + 0.5) / steps;
    sum += 2 * cosine * dielectric_reflectance(cosine, ior);
  }
  return sum / steps;
}

/// Density of a Beckmann distribution of normals over projected area. @param alpha2 its roughness squared.
double beckmann(double cosine, double alpha2) {
  if (cosine <= 0) return 0;
  const double cos2 = cosine * cosine;
  return std::exp((1 - 1 / cos2) / alpha2) / (kPi * alpha2 * cos2 * cos2);
}

}  // namespace

CoatInterface::CoatInterface(const CoatDescription& coat)
    : coat_(coat),
      // As much light crosses one way as the other, over n^2 times the solid angle.
      inner_reflectance_(1 - (1 - outer_reflectance(coat.ior)) / (coat.ior * coat.ior)) {}

Eigen::Vector3d CoatInterface::refracted(const Eigen::Vector3d& direction, const Eigen::Vector3d& n) const {
  const double cosine = direction.dot(n);
  const Eigen::Vector3d sideways = (direction - cosine * n) / coat_.ior;
  return sideways + std::sqrt(std::max(0.0, 1 - sideways.squaredNorm())) * n;
}

double CoatInterface::crossing(double cos_o, double cos_i) const {
  return (1 - dielectric_reflectance(cos_o, coat_.ior)) * (1 - dielectric_reflectance(cos_i, coat_.ior)) /
         (coat_.ior * coat_.ior);
}

Color CoatInterface::diffuse(const Color& albedo, double cos_o, double cos_i) const {
  const Color all_bounces = (albedo.array() / (1 - inner_reflectance_ * albedo.array())).matrix();
  return crossing(cos_o, cos_i) / kPi * all_bounces;
}

Color CoatInterface::glint_weight(const Fresnel& fresnel, double masking_alpha, const Eigen::Vector3d& n,
                                  const Eigen::Vector3d& to_eye, const Eigen::Vector3d& to_light) const {
  const Eigen::Vector3d eye_below = refracted(to_eye, n), light_below = refracted(to_light, n);
  // The weight below holds the cosine inside the coat; irradiance is that outside.
  const double cosines = to_light.dot(n) / light_below.dot(n);
  return crossing(to_eye.dot(n), to_light.dot(n)) * cosines *
         mica::host::glint_weight(fresnel, masking_alpha, n, eye_below, light_below);
}

double CoatInterface::reflection(const Eigen::Vector3d& n, const Eigen::Vector3d& to_eye,
                                 const Eigen::Vector3d& to_light, double light_variance) const {
  const double alpha2 = 2 * (coat_.roughness * coat_.roughness + light_variance);
  const double cosine = (to_eye + to_light).normalized().dot(n);
  return mica::host::glint_weight(DielectricFresnel{coat_.ior}, std::sqrt(2.0) * coat_.roughness, n, to_eye,
                                  to_light)[0] *
         beckmann(cosine, alpha2);
}

}  // namespace mica::host
