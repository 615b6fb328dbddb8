#include <Eigen/Geometry>
#include <cmath>

#include "host/gbuffer/view.h"

namespace mica::host {

BufferCamera::BufferCamera(const Description& camera, int width, int height)
    : is_orthographic_(camera.is_orthographic),
      position_(camera.to_world.block<3, 1>(0, 3)),
      right_(camera.to_world.block<3, 1>(0, 0).normalized()),
      up_(camera.to_world.block<3, 1>(0, 1).normalized()),
      forward_(-camera.to_world.block<3, 1>(0, 2).normalized()) {
  // A side in pixels of the image's width: those of other shapes count by their height.
  const double fitted = camera.fits_width ? width : height * camera.pixel_aspect;
  const double pixel = camera.extent / fitted;
  pixel_ = {pixel, pixel * camera.pixel_aspect};
  middle_ = {width / 2.0 - camera.shift.x() * fitted,
             height / 2.0 + camera.shift.y() * fitted / camera.pixel_aspect};
}

BufferCamera::Sight BufferCamera::sight(const Eigen::Vector3d& position) const {
  const Eigen::Vector3d ddx = pixel_.x() * right_, ddy = -pixel_.y() * up_;
  // All rays of an orthographic camera are parallel: a step of a pixel at unit distance is one anywhere.
  if (is_orthographic_) return {{position - forward_, forward_, ddx, ddy}, 1};
  const double t = (position - position_).dot(forward_);
  return {{position_, (position - position_) / t, ddx, ddy}, t};
}

std::optional<Eigen::Vector2d> BufferCamera::project(const Eigen::Vector3d& position) const {
  const Eigen::Vector3d from_camera = position - position_;
  const double depth = from_camera.dot(forward_), distance = is_orthographic_ ? 1 : depth;
  if (!(depth > 0)) return std::nullopt;
  return middle_ + Eigen::Vector2d(from_camera.dot(right_) / (distance * pixel_.x()),
                                   -from_camera.dot(up_) / (distance * pixel_.y()));
}

double SpotCone::share(const Eigen::Vector3d& point) const {
  const double cosine = (point - position).normalized().dot(axis), inside = cosine - cos_half_angle;
  if (!(inside > 0)) return 0;
  const double fall = falls_with_cosine ? cosine : 1, width = blend * (1 - cos_half_angle);
  if (inside >= width) return fall;
  const double x = inside / width;
  return fall * x * x * (3 - 2 * x);
}

}  // namespace mica::host
