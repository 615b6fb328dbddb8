#include "host/scene/lobes.h"

#include <algorithm>
#include <cmath>

#include "host/microfacet/horizon.h"
#include "host/microfacet/masking.h"
#include "host/scene/fresnel.h"

namespace mica::host {
namespace {

constexpr double kLargestRoughness = 1;  // evaluators take no more

/// Roughness of a query whose light has an extent.
double widened(double roughness, double half_variance) {
  return half_variance > 0 ? std::min(kLargestRoughness, std::sqrt(roughness * roughness + half_variance))
                           : roughness;
}

/// dt/di of a direction i above a surface that is refracted to t: what is parallel to the surface shrinks by
/// the index [Snell], and t stays unit.
Eigen::Matrix3d refraction_change(const Eigen::Vector3d& n, const Eigen::Vector3d& t, double ior) {
  if (ior == 1) return Eigen::Matrix3d::Identity();
  const double cosine = std::max(t.dot(n), kMinCosine);
  const Eigen::Matrix3d parallel = Eigen::Matrix3d::Identity() - n * n.transpose();
  return (Eigen::Matrix3d::Identity() - n * (t - t.dot(n) * n).transpose() / cosine) * parallel / ior;
}

/// dh/dt of the half vector h between o and t.
Eigen::Matrix3d half_vector_change(const Eigen::Vector3d& o, const Eigen::Vector3d& t) {
  const Eigen::Vector3d sum = o + t, h = sum.normalized();
  return (Eigen::Matrix3d::Identity() - h * h.transpose()) / std::max(sum.norm(), kMinCosine);
}

}  // namespace

LobesSeen see_lobes(const LayeredMaterial& layers, const Eigen::Vector3d& n, const Eigen::Vector3d& to_eye,
                    const Illumination& incident) {
  const double cos_o = std::max(to_eye.dot(n), kMinCosine), cos_i = incident.direction.dot(n);
  const double ior = layers.coat ? layers.coat->ior() : 1;
  LobesSeen seen;
  seen.smooth = layers.energy.diffuse(cos_o, cos_i) * cos_i;
  if (layers.coat)
    seen.smooth.array() += layers.coat->reflection(n, to_eye, incident.direction, incident.variance);
  seen.to_eye = layers.coat ? layers.coat->refracted(to_eye, n) : to_eye;
  seen.to_light = layers.coat ? layers.coat->refracted(incident.direction, n) : incident.direction;
  seen.half_vector = (seen.to_eye + seen.to_light).normalized();
  // Refraction makes a small light smaller by the index.
  const double cos_d = seen.to_light.dot(seen.half_vector);
  seen.roughness =
      widened(layers.material.roughness, half_vector_variance(incident.variance / (ior * ior), cos_d));
  const Eigen::Matrix3d turned =
      half_vector_change(seen.to_eye, seen.to_light) * refraction_change(n, seen.to_light, ior);
  seen.half_vector_cov = turned * incident.cov * turned.transpose();
  seen.mirrored = reflectance(layers.material.specular, cos_d).cwiseProduct(layers.passed(cos_o, cos_i));
  const double cos_o_below = std::max(seen.to_eye.dot(n), kMinCosine);
  const double G = smith_masking_shadowing(cos_o_below, seen.to_light.dot(n), layers.masking_alpha);
  seen.glint_weight = seen.mirrored * (G / (4 * cos_o_below));  // [Yan14] Eq. 1
  return seen;
}

}  // namespace mica::host
