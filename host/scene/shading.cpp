#include "host/scene/shading.h"

#include <Eigen/Geometry>
#include <limits>

#include "host/scene/fresnel.h"
#include "host/scene/masking.h"

namespace mica {
namespace {

struct Illuminate {
  const Eigen::Vector3d& position;

  Illumination operator()(const PointLight& light) const {
    const Eigen::Vector3d to_light = light.position - position;
    const double distance2 = to_light.squaredNorm();
    if (!(distance2 > 0)) return {Eigen::Vector3d::Zero(), 0, Color::Zero()};
    const double distance = std::sqrt(distance2);
    return {to_light / distance, distance, light.intensity / distance2};
  }
  Illumination operator()(const DirectionalLight& light) const {
    return {-light.direction.normalized(), std::numeric_limits<double>::infinity(), light.irradiance};
  }
};

}  // namespace

TangentFrame tangent_frame(const Hit& hit, const Eigen::Vector3d& to_eye) {
  TangentFrame frame;
  frame.face_normal = hit.face_normal.dot(to_eye) < 0 ? Eigen::Vector3d(-hit.face_normal) : hit.face_normal;
  frame.z = hit.normal.dot(frame.face_normal) < 0 ? Eigen::Vector3d(-hit.normal) : hit.normal;
  // An interpolated normal may turn away from an eye that sees its face.
  if (frame.z.dot(to_eye) < min_cosine) frame.z = frame.face_normal;

  const Eigen::Vector3d x = hit.tangent - hit.tangent.dot(frame.z) * frame.z;
  const bool has_direction = x.norm() > 1e-6 * hit.tangent.norm();
  frame.x = has_direction ? x.normalized() : frame.z.unitOrthogonal();
  frame.y = frame.z.cross(frame.x);
  if (frame.y.dot(hit.dpdv) < 0) frame.y = -frame.y;
  return frame;
}

Illumination illuminate(const LightDescription& light, const Eigen::Vector3d& position) {
  return std::visit(Illuminate{position}, light);
}

BounceFresnel::BounceFresnel(const Fresnel& fresnel, const Eigen::Vector3d& view,
                             const Eigen::Vector3d& light)
    : single(reflectance(fresnel, light.dot((view + light).normalized()))),
      multiple(reflectance(fresnel, view.z())) {}

Color glint_weight(const Fresnel& fresnel, double masking_alpha, const Eigen::Vector3d& n,
                   const Eigen::Vector3d& to_eye, const Eigen::Vector3d& to_light) {
  const Eigen::Vector3d half = (to_eye + to_light).normalized();
  const double cos_o = to_eye.dot(n), cos_i = to_light.dot(n);
  const double G = smith_masking_shadowing(cos_o, cos_i, masking_alpha);
  return reflectance(fresnel, to_light.dot(half)) * (G / (4 * cos_o));
}

}  // namespace mica
