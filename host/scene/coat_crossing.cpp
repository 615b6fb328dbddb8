#include "host/scene/coat_crossing.h"

#include <cmath>

namespace mica::host {

CoatCrossing::CoatCrossing(const std::optional<CoatInterface>& coat, const Eigen::Vector3d& view)
    : coat_(coat), view_(view), view_below_(below(view)) {}

Eigen::Vector3d CoatCrossing::below(const Eigen::Vector3d& light) const {
  return coat_ ? coat_->refracted(light, Eigen::Vector3d::UnitZ()) : light;
}

Eigen::Vector3d CoatCrossing::above(const Eigen::Vector3d& light_below) const {
  if (!coat_) return light_below;
  const Eigen::Vector2d sideways = coat_->ior() * light_below.head<2>();
  const double rest = 1 - sideways.squaredNorm();
  if (!(rest > 0 && light_below.z() > 0)) return -Eigen::Vector3d::UnitZ();
  return {sideways.x(), sideways.y(), std::sqrt(rest)};
}

double CoatCrossing::value_scale(const Eigen::Vector3d& light) const {
  return coat_ ? coat_->crossing(view_.z(), light.z()) * light.z() / below(light).z() : 1;
}

// Snell: n^2 cos' d below = cos d light.
double CoatCrossing::density_scale(const Eigen::Vector3d& light) const {
  return coat_ ? light.z() / (coat_->ior() * coat_->ior() * below(light).z()) : 1;
}

}  // namespace mica::host
