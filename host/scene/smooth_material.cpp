#include "host/scene/smooth_material.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "host/scene/fresnel.h"
#include "host/scene/masking.h"
#include "host/scene/shading.h"

namespace mica {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double least_alpha =
    1e-3;  // of a flat map: smoother is a mirror, which no draw towards a light meets

/// [Che18] Eq. 4, centred and isotropic.
double beckmann_density(const Eigen::Vector3d& half, double alpha) {
  const double cos2 = half.z() * half.z(), tan2 = (1 - cos2) / cos2;
  return std::exp(-tan2 / (alpha * alpha)) / (pi * alpha * alpha * cos2 * cos2);
}

bool above_horizon(const Eigen::Vector3d& view, const Eigen::Vector3d& light) {
  return view.z() >= min_cosine && light.z() >= min_cosine;
}

}  // namespace

SmoothMaterial::SmoothMaterial(const MaterialDescription& material, double alpha)
    : material_(material),
      alpha_(std::max(alpha, least_alpha)),
      normals_(Eigen::Matrix2d::Identity() * (alpha_ * alpha_ / 2)) {}

double SmoothMaterial::diffuse_share(const Eigen::Vector3d& view) const {
  const double diffuse = material_.diffuse.maxCoeff();
  return diffuse / (diffuse + std::max(reflectance(material_.specular, view.z()).maxCoeff(), 0.05));
}

Color SmoothMaterial::value(const Eigen::Vector3d& view, const Eigen::Vector3d& light) const {
  if (!above_horizon(view, light)) return Color::Zero();
  const Eigen::Vector3d half = (view + light).normalized();
  const double D = beckmann_density(half, alpha_);
  return material_.diffuse * (light.z() / pi) +
         D * glint_weight(material_.specular, alpha_, Eigen::Vector3d::UnitZ(), view, light);
}

Eigen::Vector3d SmoothMaterial::sample(const Eigen::Vector3d& view, const Eigen::Vector3d& uniform) const {
  if (uniform.z() < diffuse_share(view)) {
    const double radius = std::sqrt(uniform.x()), azimuth = 2 * pi * uniform.y();
    return {radius * std::cos(azimuth), radius * std::sin(azimuth), std::sqrt(1 - uniform.x())};
  }
  const Eigen::Vector3d half = normals_.sample(view, uniform.head<2>());
  return (2 * half.dot(view) * half - view).normalized();
}

double SmoothMaterial::pdf(const Eigen::Vector3d& view, const Eigen::Vector3d& light) const {
  if (!above_horizon(view, light)) return 0;
  const double diffuse = diffuse_share(view);
  return diffuse * light.z() / pi + (1 - diffuse) * normals_.pdf(view, (view + light).normalized());
}

}  // namespace mica
