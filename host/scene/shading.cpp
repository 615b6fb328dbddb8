#include "host/scene/shading.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "host/base/constants.h"
#include "host/microfacet/horizon.h"
#include "host/scene/disk_cells.h"

namespace mica::host {
namespace {

/// What of a vector is perpendicular to a unit one.
Eigen::Matrix3d across(const Eigen::Vector3d& unit) {
  return Eigen::Matrix3d::Identity() - unit * unit.transpose();
}

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
    const double sine = std::sin(light.angular_radius), variance = sine * sine / 4;
    const Eigen::Vector3d direction = -light.direction.normalized();
    return {direction, std::numeric_limits<double>::infinity(), light.irradiance, variance,
            variance * across(direction)};
  }
  Illumination operator()(const SphereLight& light) const {
    Illumination seen = (*this)(PointLight{light.position, light.intensity});
    if (seen.distance <= light.radius) return {seen.direction, 0, Color::Zero()};  // inside it
    // A disk of angular radius a has a variance of a^2 / 4 an axis.
    const double sine = light.radius / seen.distance;
    seen.variance = sine * sine / 4;
    seen.cov = seen.variance * across(seen.direction);
    seen.distance -= light.radius;
    return seen;
  }
  /// The vector irradiance of a disk that is as bright everywhere and from every angle, L int w dw over the
  /// directions in which it is seen, by a contour integral around its rim: E = (L / 2) int r x dr / r^2. Its
  /// length is the irradiance on a surface that faces it, its product with a normal that on any surface
  /// above whose horizon all of the disk lies. J. H. Lambert, Photometria (1760).
  Illumination operator()(const DiskLight& light) const {
    const Eigen::Vector3d axis = light.direction.normalized(), from_center = position - light.position;
    const double height = from_center.dot(axis);
    if (!(height > 0)) return {-axis, 0, Color::Zero()};  // behind it
    const Eigen::Vector3d aside = from_center - height * axis;
    const double sum = light.radius * light.radius + from_center.squaredNorm();
    const double root =
        std::sqrt(std::max(0.0, sum * sum - 4 * light.radius * light.radius * aside.squaredNorm()));
    const Eigen::Vector3d vector =
        (-(1 - 2 * aside.squaredNorm() / (sum + root)) * axis - 2 * height / (sum + root) * aside) / root;
    Illumination seen;
    seen.direction = vector.normalized();
    seen.distance = height / -seen.direction.dot(axis);
    seen.irradiance = light.intensity * vector.norm();
    // Foreshortened along one axis: the mean of both. Near by it fills no more than the sky.
    const double cosine2 = height * height / from_center.squaredNorm();
    const double tangent2 = light.radius * light.radius / from_center.squaredNorm();
    const double facing = tangent2 / (1 + tangent2) / 4;
    seen.variance = facing * (1 + cosine2) / 2;
    seen.cov = facing * across(seen.direction) * across(axis) * across(seen.direction);
    return seen;
  }
};

/// The middle of a light from a place, and the axes of the disk that it is.
struct DiskFrom {
  const Eigen::Vector3d& position;
  struct Disk {
    Eigen::Vector3d middle, x, y;
  };

  Disk operator()(const PointLight& light) const { return {light.position - position, none(), none()}; }
  Disk operator()(const DirectionalLight& light) const {
    return {-light.direction.normalized(), none(), none()};
  }
  /// The disk that is the sphere's outline.
  Disk operator()(const SphereLight& light) const {
    return disk(light.position, light.position - position, light.radius);
  }
  Disk operator()(const DiskLight& light) const {
    return disk(light.position, light.direction, light.radius);
  }

 private:
  static Eigen::Vector3d none() { return Eigen::Vector3d::Zero(); }
  Disk disk(const Eigen::Vector3d& center, const Eigen::Vector3d& axis, double radius) const {
    const Eigen::Vector3d z = axis.normalized(), x = z.unitOrthogonal();
    return {center - position, radius * x, radius * z.cross(x)};
  }
};

/// A part of a light's disk, as bright as the cell is large.
struct IlluminatePart {
  const Eigen::Vector3d& position;
  const Illumination& whole;
  const DiskCell& cell;

  Illumination operator()(const PointLight&) const { return whole; }
  Illumination operator()(const DirectionalLight& light) const {
    return of_cone(std::sin(light.angular_radius));
  }
  Illumination operator()(const SphereLight& light) const {
    return of_cone(light.radius / (light.position - position).norm());
  }
  Illumination operator()(const DiskLight& light) const {
    const DiskFrom::Disk disk = DiskFrom{position}(light);
    const Eigen::Vector3d to_part = disk.middle + cell.mean.x() * disk.x + cell.mean.y() * disk.y;
    Illumination part = whole;
    part.distance = to_part.norm();
    part.direction = to_part / part.distance;
    const double facing = std::max(-part.direction.dot(light.direction.normalized()), 0.0);
    part.irradiance = cell.share * facing / (part.distance * part.distance) * light.intensity;
    Eigen::Matrix<double, 3, 2> moves;
    moves << disk.x, disk.y;
    spread(across(part.direction) * moves / part.distance, &part);
    return part;
  }

 private:
  /// A sphere's points are alike in the sines of their angles to its middle.
  Illumination of_cone(double sine) const {
    const Eigen::Vector3d &z = whole.direction, x = z.unitOrthogonal(), y = z.cross(x);
    const double cosine = std::sqrt(std::max(1 - sine * sine * cell.mean.squaredNorm(), kMinCosine));
    Illumination part = whole;
    part.direction = cosine * z + sine * (cell.mean.x() * x + cell.mean.y() * y);
    part.irradiance = cell.share / cosine * whole.irradiance;
    Eigen::Matrix<double, 3, 2> moves;
    moves << x, y;
    spread(sine * moves - sine * sine / cosine * z * cell.mean.transpose(), &part);
    return part;
  }
  /// @param moves the change of the direction over the disk.
  void spread(const Eigen::Matrix<double, 3, 2>& moves, Illumination* part) const {
    part->cov = moves * cell.cov * moves.transpose();
    part->variance = part->cov.trace() / 2;
  }
};

}  // namespace

TangentFrame tangent_frame(const Hit& hit, const Eigen::Vector3d& to_eye) {
  TangentFrame frame;
  frame.face_normal = hit.face_normal.dot(to_eye) < 0 ? Eigen::Vector3d(-hit.face_normal) : hit.face_normal;
  frame.z = hit.normal.dot(frame.face_normal) < 0 ? Eigen::Vector3d(-hit.normal) : hit.normal;
  // An interpolated normal may turn away from an eye that sees its face.
  if (frame.z.dot(to_eye) < kMinCosine) frame.z = frame.face_normal;

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

std::vector<Illumination> illuminate_by_parts(const LightDescription& light, const Eigen::Vector3d& position,
                                              const Illumination& whole, int rings) {
  if (rings == 0 || !(whole.variance > 0)) return {whole};
  std::vector<Illumination> parts;
  double arrived = 0, expected = whole.irradiance.sum();
  for (const DiskCell& cell : disk_cells(rings)) {
    const Illumination& part = parts.emplace_back(std::visit(IlluminatePart{position, whole, cell}, light));
    arrived += part.irradiance.sum() * part.direction.dot(whole.direction);
  }
  if (!(arrived > 0)) return {whole};
  for (Illumination& part : parts) part.irradiance *= expected / arrived;
  return parts;
}

bool has_extent(const LightDescription& light) {
  if (const auto* sphere = std::get_if<SphereLight>(&light)) return sphere->radius > 0;
  if (const auto* disk = std::get_if<DiskLight>(&light)) return disk->radius > 0;
  return false;
}

bool widens_lobes(const LightDescription& light) {
  const auto* directional = std::get_if<DirectionalLight>(&light);
  return directional ? directional->angular_radius > 0 : has_extent(light);
}

ShadowRays::ShadowRays(const LightDescription& light, const Eigen::Vector3d& position)
    : is_far_(std::holds_alternative<DirectionalLight>(light)) {
  const DiskFrom::Disk disk = std::visit(DiskFrom{position}, light);
  middle_ = disk.middle, x_ = disk.x, y_ = disk.y;
}

ShadowRay ShadowRays::to(const Eigen::Vector2d& on_disk) const {
  const Eigen::Vector3d to_light = middle_ + on_disk.x() * x_ + on_disk.y() * y_;
  if (is_far_) return {to_light, std::numeric_limits<double>::infinity()};
  return {to_light.stableNormalized(), to_light.norm()};
}

double half_vector_variance(double light_variance, double cos_d) {
  constexpr double least_cosine = 0.1;  // beyond it the spread is no longer small
  const double across = 1 / std::max(cos_d, least_cosine);
  return light_variance / 4 * (1 + across * across) / 2;
}

}  // namespace mica::host
