#include "host/scene/smooth_material.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "host/base/constants.h"
#include "host/microfacet/horizon.h"
#include "host/scene/fresnel.h"
#include "host/scene/lobes.h"
#include "host/scene/shading.h"

namespace mica::host {
namespace {

bool above_horizon(const Eigen::Vector3d& view, const Eigen::Vector3d& light) {
  return view.z() >= kMinCosine && light.z() >= kMinCosine;
}

VisibleNormals isotropic_normals(double slope_sigma) {
  return VisibleNormals(Eigen::Matrix2d::Identity() * (slope_sigma * slope_sigma));
}

}  // namespace

SmoothMaterial::SmoothMaterial(const LayeredMaterial& layers, std::optional<SmoothNormals> normals)
    : layers_(layers),
      normals_(std::move(normals)),
      diffuse_weight_(layers.material.diffuse.maxCoeff()),
      coat_weight_(layers.coat ? 0.3 : 0),
      normals_weight_(
          normals_
              ? std::max(reflectance(layers.material.specular, 1).cwiseProduct(normals_->tint).maxCoeff(),
                         0.05)
              : 0),
      coat_normals_(isotropic_normals(layers.coat ? layers.material.coat->roughness : 1)) {}

Color SmoothMaterial::value(const Eigen::Vector3d& view, const Eigen::Vector3d& light) const {
  if (!above_horizon(view, light)) return Color::Zero();
  const Illumination incident{light, std::numeric_limits<double>::infinity(), Color::Ones(), 0};
  const LobesSeen seen = see_lobes(layers_, Eigen::Vector3d::UnitZ(), view, incident);
  if (!normals_) return seen.smooth;
  const double D = normals_->lobe.density(seen.half_vector),
               G = normals_->lobe.masking_shadowing(seen.to_eye, seen.to_light);
  const Color mirrored =
      seen.mirrored.cwiseProduct(layers_.regained(seen.to_eye)).cwiseProduct(normals_->tint);
  return seen.smooth + mirrored * (D * G / (4 * seen.to_eye.z()));
}

Eigen::Vector3d SmoothMaterial::sample(const Eigen::Vector3d& view, const Eigen::Vector3d& uniform) const {
  const double lobe = uniform.z() * (diffuse_weight_ + coat_weight_ + normals_weight_);
  if (lobe < diffuse_weight_) {
    const double radius = std::sqrt(uniform.x()), azimuth = 2 * kPi * uniform.y();
    return {radius * std::cos(azimuth), radius * std::sin(azimuth), std::sqrt(1 - uniform.x())};
  }
  const VisibleNormals& normals =
      lobe < diffuse_weight_ + coat_weight_ || !normals_ ? coat_normals_ : normals_->lobe.visible_normals();
  const Eigen::Vector3d half = normals.sample(view, uniform.head<2>());
  return (2 * half.dot(view) * half - view).normalized();
}

double SmoothMaterial::pdf(const Eigen::Vector3d& view, const Eigen::Vector3d& light) const {
  if (!above_horizon(view, light)) return 0;
  const Eigen::Vector3d half = (view + light).normalized();
  double sum = diffuse_weight_ * light.z() / kPi;
  if (coat_weight_ > 0) sum += coat_weight_ * coat_normals_.pdf(view, half);
  if (normals_) sum += normals_weight_ * normals_->lobe.visible_normals().pdf(view, half);
  return sum / (diffuse_weight_ + coat_weight_ + normals_weight_);
}

}  // namespace mica::host
