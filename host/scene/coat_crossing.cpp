#include "host/scene/coat_crossing.h"

#include <cmath>

namespace mica::host {

CoatCrossing::CoatCrossing(const LayeredMaterial& layers, const Eigen::Vector3d& view)
    : layers_(layers), view_(view), view_below_(below(view)) {}

Eigen::Vector3d CoatCrossing::below(const Eigen::Vector3d& light) const {
  return layers_.coat ? layers_.coat->refracted(light, Eigen::Vector3d::UnitZ()) : light;
}

Eigen::Vector3d CoatCrossing::above(const Eigen::Vector3d& light_below) const {
  if (!layers_.coat) return light_below;
  const Eigen::Vector2d sideways = layers_.coat->ior() * light_below.head<2>();
  const double rest = 1 - sideways.squaredNorm();
  if (!(rest > 0 && light_below.z() > 0)) return -Eigen::Vector3d::UnitZ();
  return {sideways.x(), sideways.y(), std::sqrt(rest)};
}

Color CoatCrossing::value_scale(const Eigen::Vector3d& light) const {
  return layers_.passed(view_.z(), light.z()).cwiseProduct(layers_.regained(view_below_));
}

// Snell: n^2 cos' d below = cos d light.
double CoatCrossing::density_scale(const Eigen::Vector3d& light) const {
  return layers_.coat ? light.z() / (layers_.coat->ior() * layers_.coat->ior() * below(light).z()) : 1;
}

}  // namespace mica::host
