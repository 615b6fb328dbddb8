#include "host/scene/camera.h"

#include <Eigen/Geometry>
#include <cmath>

#include "host/base/constants.h"
#include "mica/error.h"

namespace mica::host {

PinholeCamera::PinholeCamera(const CameraDescription& description, int width, int height)
    : position_(description.position) {
  const Eigen::Vector3d axis = description.look_at - description.position;
  const Eigen::Vector3d side = axis.cross(description.up);
  if (!(axis.allFinite() && axis.norm() > 0)) throw UsageError("camera: position and look_at must differ");
  if (!(side.allFinite() && side.norm() > 1e-9 * axis.norm() * description.up.norm()))
    throw UsageError("camera: up must not be parallel to the direction of view");
  if (!(description.fov_degrees > 0 && description.fov_degrees < 180))
    throw UsageError("camera: fov must lie between 0 and 180 degrees");

  constexpr double degree = kPi / 180;
  const double pixel = 2 * std::tan(description.fov_degrees * degree / 2) / height;
  const Eigen::Vector3d forward = axis.normalized(), right = side.normalized();
  ddx_ = pixel * right;
  ddy_ = -pixel * right.cross(forward);
  top_left_ = forward - 0.5 * width * ddx_ - 0.5 * height * ddy_;
}

CameraRay PinholeCamera::ray(double x, double y) const {
  return {position_, top_left_ + x * ddx_ + y * ddy_, ddx_, ddy_};
}

}  // namespace mica::host
