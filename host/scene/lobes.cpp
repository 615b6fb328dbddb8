#include "host/scene/lobes.h"

#include <algorithm>
#include <cmath>

#include "host/base/constants.h"
#include "host/microfacet/horizon.h"

namespace mica::host {
namespace {

constexpr double kLargestRoughness = 1;  // evaluators take no more

/// Roughness of a query whose light has an extent.
double widened(double roughness, double half_variance) {
  return half_variance > 0 ? std::min(kLargestRoughness, std::sqrt(roughness * roughness + half_variance))
                           : roughness;
}

LobesSeen see_bare(const MaterialDescription& material, double masking_alpha, const Eigen::Vector3d& n,
                   const Eigen::Vector3d& to_eye, const Illumination& incident) {
  const Eigen::Vector3d& to_light = incident.direction;
  const Eigen::Vector3d half = (to_eye + to_light).normalized();
  const double variance = half_vector_variance(incident.variance, to_light.dot(half));
  return {material.diffuse / kPi * to_light.dot(n), half, widened(material.roughness, variance),
          glint_weight(material.specular, masking_alpha, n, to_eye, to_light)};
}

LobesSeen see_coated(const MaterialDescription& material, const CoatInterface& coat, double masking_alpha,
                     const Eigen::Vector3d& n, const Eigen::Vector3d& to_eye, const Illumination& incident) {
  const Eigen::Vector3d& to_light = incident.direction;
  const double cos_o = std::max(to_eye.dot(n), kMinCosine), cos_i = to_light.dot(n);
  const Eigen::Vector3d light_below = coat.refracted(to_light, n);
  const Eigen::Vector3d half_below = (coat.refracted(to_eye, n) + light_below).normalized();
  // Refraction makes a small light smaller by the index.
  const double variance_below =
      half_vector_variance(incident.variance / (coat.ior() * coat.ior()), light_below.dot(half_below));
  const double variance =
      half_vector_variance(incident.variance, to_light.dot((to_eye + to_light).normalized()));
  const Color smooth = coat.diffuse(material.diffuse, cos_o, cos_i) * cos_i +
                       Color::Constant(coat.reflection(n, to_eye, to_light, variance));
  return {smooth, half_below, widened(material.roughness, variance_below),
          coat.glint_weight(material.specular, masking_alpha, n, to_eye, to_light)};
}

}  // namespace

LobesSeen see_lobes(const MaterialDescription& material, const std::optional<CoatInterface>& coat,
                    double masking_alpha, const Eigen::Vector3d& n, const Eigen::Vector3d& to_eye,
                    const Illumination& incident) {
  return coat ? see_coated(material, *coat, masking_alpha, n, to_eye, incident)
              : see_bare(material, masking_alpha, n, to_eye, incident);
}

}  // namespace mica::host
