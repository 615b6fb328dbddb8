#include "host/scene/keyframes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace mica::host {
namespace {

template <class Value>
Value mix(const Value& a, const Value& b, double share) {
  return (1 - share) * a + share * b;
}

/// From one direction to another, of any lengths, at constant speed; opposite ones over one of those across.
Eigen::Vector3d turn(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double share) {
  const Eigen::Vector3d a = from.stableNormalized(), b = to.stableNormalized();
  const Eigen::Vector3d rest = b - a.dot(b) * a;
  const double angle = share * std::atan2(rest.norm(), a.dot(b));
  const Eigen::Vector3d across = rest.norm() > 1e-9 ? rest.normalized() : a.unitOrthogonal();
  return std::cos(angle) * a + std::sin(angle) * across;
}

CameraDescription between(const CameraDescription& a, const CameraDescription& b, double share) {
  CameraDescription camera = a;
  camera.position = mix(a.position, b.position, share);
  camera.look_at = mix(a.look_at, b.look_at, share);
  camera.up = turn(a.up, b.up, share);
  camera.fov_degrees = mix(a.fov_degrees, b.fov_degrees, share);
  return camera;
}

PointLight between(const PointLight& a, const PointLight& b, double share) {
  return {mix(a.position, b.position, share), mix(a.intensity, b.intensity, share)};
}

DirectionalLight between(const DirectionalLight& a, const DirectionalLight& b, double share) {
  return {turn(a.direction, b.direction, share), mix(a.irradiance, b.irradiance, share)};
}

SphereLight between(const SphereLight& a, const SphereLight& b, double share) {
  return {mix(a.position, b.position, share), mix(a.radius, b.radius, share),
          mix(a.intensity, b.intensity, share)};
}

DiskLight between(const DiskLight& a, const DiskLight& b, double share) {
  return {mix(a.position, b.position, share), turn(a.direction, b.direction, share),
          mix(a.radius, b.radius, share), mix(a.intensity, b.intensity, share)};
}

LightDescription between(const LightDescription& a, const LightDescription& b, double share) {
  return std::visit(
      [&](const auto& light) -> LightDescription {
        return between(light, std::get<std::decay_t<decltype(light)>>(b), share);
      },
      a);
}

template <class Described>
Described at(const Keyframes<Described>& keys, double frame, const Described& still) {
  if (keys.empty()) return still;
  const auto after =
      std::find_if(keys.begin(), keys.end(), [&](const auto& key) { return key.frame > frame; });
  if (after == keys.begin()) return keys.front().value;
  if (after == keys.end()) return keys.back().value;
  const auto before = std::prev(after);
  return between(before->value, after->value, (frame - before->frame) / (after->frame - before->frame));
}

}  // namespace

CameraDescription camera_at(const SceneDescription& scene, double frame) {
  return at(scene.camera_keys, frame, scene.camera);
}

std::vector<LightDescription> lights_at(const SceneDescription& scene, double frame) {
  std::vector<LightDescription> lights = scene.lights;
  for (std::size_t n = 0; n < std::min(lights.size(), scene.light_keys.size()); ++n)
    lights[n] = at(scene.light_keys[n], frame, scene.lights[n]);
  return lights;
}

}  // namespace mica::host
