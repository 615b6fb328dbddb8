#include "host/render/surface_light.h"

#include <limits>

#include "host/base/random.h"
#include "host/microfacet/horizon.h"
#include "host/scene/smooth_material.h"

namespace mica::host {
namespace {

/// A point on a path.
struct Vertex {
  const Scene& scene;
  Hit hit;
  TangentFrame frame;
  Eigen::Vector3d view;  ///< in the frame
  SmoothMaterial material;

  bool sees(const Eigen::Vector3d& world, double distance) const {
    return world.dot(frame.z) >= kMinCosine && world.dot(frame.face_normal) >= kMinCosine &&
           !scene.geometry().occluded(hit, world, distance);
  }
};

Color light_of_lamps(const Vertex& vertex) {
  Color sum = Color::Zero();
  for (const LightDescription& lamp : vertex.scene.lights()) {
    const Illumination incident = illuminate(lamp, vertex.hit.position);
    if (!vertex.sees(incident.direction, incident.distance)) continue;
    sum += vertex.material.value(vertex.view, vertex.frame.to_local(incident.direction))
               .cwiseProduct(incident.irradiance);
  }
  return sum;
}

/// The part of the environment's light that draws towards it estimate; see gather_light.
Color light_of_environment(const Vertex& vertex, const Eigen::Vector2d& uniform) {
  const Environment& environment = vertex.scene.environment();
  if (environment.is_black()) return Color::Zero();
  const Eigen::Vector3d world = environment.sample(uniform), local = vertex.frame.to_local(world);
  const double pdf = environment.pdf(world);
  const Color value = vertex.material.value(vertex.view, local);
  if (!(pdf > 0) || value.isZero(0) || !vertex.sees(world, kFar)) return Color::Zero();
  return value.cwiseProduct(environment.radiance(world)) / (pdf + vertex.material.pdf(vertex.view, local));
}

}  // namespace

Color surface_light(const Scene& scene, Ray ray, int bounces, std::uint64_t key) {
  Color sum = Color::Zero(), throughput = Color::Ones();
  double pdf = 0;  // of the ray's direction; 0 where light from afar is not ours to count
  for (int bounce = 0; bounce <= bounces; ++bounce) {
    const std::optional<Hit> hit = scene.geometry().intersect(ray);
    if (!hit) {
      if (pdf > 0)
        sum += throughput.cwiseProduct(scene.environment().radiance(ray.direction)) *
               (pdf / (pdf + scene.environment().pdf(ray.direction)));
      break;
    }
    if (bounce == bounces) break;
    const auto random = [&](std::uint64_t dimension) {
      return random_unit(key, static_cast<std::uint64_t>(bounce), dimension);
    };
    const Eigen::Vector3d to_eye = -ray.direction.normalized();
    const TangentFrame frame = tangent_frame(*hit, to_eye);
    if (frame.face_normal.dot(to_eye) < kMinCosine) break;
    const std::uint32_t material = scene.material_of(*hit);
    const Vertex vertex{scene, *hit, frame, frame.to_local(to_eye),
                        SmoothMaterial(scene.layers(material), scene.normals_from_afar(material, *hit))};
    sum += throughput.cwiseProduct(light_of_lamps(vertex) +
                                   light_of_environment(vertex, {random(0), random(1)}));

    const Eigen::Vector3d next = vertex.material.sample(vertex.view, {random(2), random(3), random(4)});
    pdf = vertex.material.pdf(vertex.view, next);
    const Eigen::Vector3d world = frame.to_world(next);
    if (!(pdf > 0) || world.dot(frame.face_normal) < kMinCosine) break;
    throughput = throughput.cwiseProduct(vertex.material.value(vertex.view, next)) / pdf;
    if (throughput.isZero(0)) break;
    ray = ray_from(*hit, world);
  }
  return sum;
}

}  // namespace mica::host
