#include "host/scene/smooth_material.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "host/base/constants.h"
#include "host/microfacet/horizon.h"
#include "host/scene/fresnel.h"
#include "host/scene/lobes.h"
#include "host/scene/shading.h"

namespace mica::host {
namespace {

constexpr double kLeastAlpha =
    1e-3;  // a flat map has this: smoother is a mirror, which no draw towards a light meets

/// [Che18] Eq. 4, centred and isotropic.
double beckmann_density(const Eigen::Vector3d& half, double alpha) {
  const double cos2 = half.z() * half.z(), tan2 = (1 - cos2) / cos2;
  return std::exp(-tan2 / (alpha * alpha)) / (kPi * alpha * alpha * cos2 * cos2);
}

bool above_horizon(const Eigen::Vector3d& view, const Eigen::Vector3d& light) {
  return view.z() >= kMinCosine && light.z() >= kMinCosine;
}

VisibleNormals isotropic_normals(double slope_sigma) {
  return VisibleNormals(Eigen::Matrix2d::Identity() * (slope_sigma * slope_sigma));
}

}  // namespace

SmoothMaterial::SmoothMaterial(const LayeredMaterial& layers, Lobes lobes)
    : layers_(layers),
      alpha_(std::max(layers.masking_alpha, kLeastAlpha)),
      diffuse_weight_(layers.material.diffuse.maxCoeff()),
      coat_weight_(layers.coat ? 0.3 : 0),
      normals_weight_(lobes == Lobes::with_smooth_normals
                          ? std::max(reflectance(layers.material.specular, 1).maxCoeff(), 0.05)
                          : 0),
      coat_normals_(isotropic_normals(layers.coat ? layers.material.coat->roughness : 1)),
      normals_(isotropic_normals(alpha_ / std::sqrt(2.0))) {}

Color SmoothMaterial::value(const Eigen::Vector3d& view, const Eigen::Vector3d& light) const {
  if (!above_horizon(view, light)) return Color::Zero();
  const Illumination incident{light, std::numeric_limits<double>::infinity(), Color::Ones(), 0};
  const LobesSeen seen = see_lobes(layers_, Eigen::Vector3d::UnitZ(), view, incident);
  if (!(normals_weight_ > 0)) return seen.smooth;
  return seen.smooth + beckmann_density(seen.half_vector, alpha_) * seen.glint_weight;
}

Eigen::Vector3d SmoothMaterial::sample(const Eigen::Vector3d& view, const Eigen::Vector3d& uniform) const {
  const double lobe = uniform.z() * (diffuse_weight_ + coat_weight_ + normals_weight_);
  if (lobe < diffuse_weight_) {
    const double radius = std::sqrt(uniform.x()), azimuth = 2 * kPi * uniform.y();
    return {radius * std::cos(azimuth), radius * std::sin(azimuth), std::sqrt(1 - uniform.x())};
  }
  const VisibleNormals& normals = lobe < diffuse_weight_ + coat_weight_ ? coat_normals_ : normals_;
  const Eigen::Vector3d half = normals.sample(view, uniform.head<2>());
  return (2 * half.dot(view) * half - view).normalized();
}

double SmoothMaterial::pdf(const Eigen::Vector3d& view, const Eigen::Vector3d& light) const {
  if (!above_horizon(view, light)) return 0;
  const Eigen::Vector3d half = (view + light).normalized();
  double sum = diffuse_weight_ * light.z() / kPi;
  if (coat_weight_ > 0) sum += coat_weight_ * coat_normals_.pdf(view, half);
  if (normals_weight_ > 0) sum += normals_weight_ * normals_.pdf(view, half);
  return sum / (diffuse_weight_ + coat_weight_ + normals_weight_);
}

}  // namespace mica::host
