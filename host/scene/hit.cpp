#include "host/scene/hit.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "host/base/constants.h"

namespace mica::host {
namespace {

/// Along a normal, from what is rounded in each axis: the floor z = 0 stays where it is however large it is
/// (Pharr, Jakob, Humphreys, "Physically Based Rendering", 4th ed., sec. 6.8).
/// But a ray that starts exactly there hits it at t = 0, so that a trace of the greatest coordinate remains.
double error_along(const Eigen::Vector3d& normal, const Eigen::Vector3d& greatest) {
  constexpr double trace = 1e-10;
  return kRelativeError * normal.cwiseAbs().dot(greatest) + trace * greatest.maxCoeff();
}

/// Of a plane through three points: their rounding, and that of the normal that is made of two edges.
double plane_error(const Eigen::Vector3d& normal, const Eigen::Vector3d& greatest,
                   const Eigen::Vector3d& edge_b, const Eigen::Vector3d& edge_c) {
  const Eigen::Vector3d b = edge_b.cwiseAbs(), c = edge_c.cwiseAbs();
  const Eigen::Vector3d products(b.y() * c.z() + b.z() * c.y(), b.z() * c.x() + b.x() * c.z(),
                                 b.x() * c.y() + b.y() * c.x());
  // In the normal's own direction its length cancels.
  const Eigen::Vector3d sideways = products.cwiseProduct(Eigen::Vector3d::Ones() - normal.cwiseAbs2());
  const double length = edge_b.cross(edge_c).norm();
  return std::min(error_along(normal, greatest) + kRelativeError * sideways.dot(greatest) / length,
                  kRelativeError * (greatest + b + c).maxCoeff());
}

/// Longitude over u from the +x axis, latitude over v from the south pole.
void parameterise_sphere(double radius, Hit* hit) {
  const Eigen::Vector3d& n = hit->normal;
  const double longitude = std::atan2(n.y(), n.x());
  hit->uv = {longitude / (2 * kPi) + (longitude < 0 ? 1 : 0),
             0.5 + std::atan2(n.z(), std::hypot(n.x(), n.y())) / kPi};
  // At the poles longitude has no direction; a point just beside them stands in.
  const double across = std::max(std::hypot(n.x(), n.y()), 1e-6);
  const double cos_longitude = std::cos(longitude), sin_longitude = std::sin(longitude);
  hit->tangent = Eigen::Vector3d(-sin_longitude, cos_longitude, 0);
  hit->dpdu = 2 * kPi * radius * across * hit->tangent;
  hit->dpdv = kPi * radius * Eigen::Vector3d(-n.z() * cos_longitude, -n.z() * sin_longitude, across);
}

/// The interpolated attribute of a triangle's corners.
template <class Vector>
auto interpolate(const std::vector<Vector>& values, const std::array<std::uint32_t, 3>& corners, double b,
                 double c) {
  const auto value = [&](std::size_t i) { return values[corners[i]].template cast<double>(); };
  return ((1 - b - c) * value(0) + b * value(1) + c * value(2)).eval();
}

}  // namespace

Hit hit_plane(const PlaneShape& plane, const Ray& ray) {
  Hit hit;
  hit.t = (plane.center.z() - ray.origin.z()) / ray.direction.z();
  hit.position = ray.origin + hit.t * ray.direction;
  hit.position.z() = plane.center.z();
  hit.face_normal = hit.normal = Eigen::Vector3d::UnitZ();
  hit.error = error_along(hit.normal, {plane.size, plane.size, std::abs(plane.center.z())});
  hit.tangent = Eigen::Vector3d::UnitX();
  hit.dpdu = plane.size * Eigen::Vector3d::UnitX();
  hit.dpdv = plane.size * Eigen::Vector3d::UnitY();
  hit.uv = (hit.position - plane.center).head<2>() / plane.size + Eigen::Vector2d::Constant(0.5);
  return hit;
}

Hit hit_sphere(const SphereShape& sphere, const Ray& ray, double t_near) {
  const Eigen::Vector3d from_center = ray.origin - sphere.center;
  const double length2 = ray.direction.squaredNorm();
  const double t_middle = -ray.direction.dot(from_center) / length2;
  const double distance2 = (from_center + t_middle * ray.direction).squaredNorm();
  // Just past the silhouette, where only single precision saw a hit, the nearest point stands in.
  const double half_chord = std::sqrt(std::max(0.0, (sphere.radius * sphere.radius - distance2) / length2));

  Hit hit;
  hit.t = t_middle + (t_near < t_middle ? -half_chord : half_chord);
  hit.face_normal = hit.normal = (from_center + hit.t * ray.direction).normalized();
  hit.position = sphere.center + sphere.radius * hit.normal;
  hit.error = kRelativeError * (hit.position.cwiseAbs().maxCoeff() + sphere.radius);
  parameterise_sphere(sphere.radius, &hit);
  return hit;
}

// Moller and Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection" (1997), sec. 2.
Hit hit_triangle(const TriangleMesh& mesh, std::uint32_t triangle, const Ray& ray) {
  const auto& corners = mesh.triangles[triangle];
  const Eigen::Vector3d a = mesh.positions[corners[0]].cast<double>();
  const Eigen::Vector3d edge_b = mesh.positions[corners[1]].cast<double>() - a;
  const Eigen::Vector3d edge_c = mesh.positions[corners[2]].cast<double>() - a;
  const Eigen::Vector3d from_a = ray.origin - a;
  const Eigen::Vector3d p = ray.direction.cross(edge_c), q = from_a.cross(edge_b);
  const double determinant = p.dot(edge_b);
  // Beyond an edge only single precision saw a hit; the edge stands in.
  const double b = std::clamp(p.dot(from_a) / determinant, 0.0, 1.0);
  const double c = std::clamp(q.dot(ray.direction) / determinant, 0.0, 1 - b);

  Hit hit;
  hit.part = mesh.part(triangle);
  hit.t = q.dot(edge_c) / determinant;
  hit.position = a + b * edge_b + c * edge_c;
  hit.face_normal = edge_b.cross(edge_c).normalized();
  const Eigen::Vector3d greatest =
      a.cwiseAbs().cwiseMax((a + edge_b).cwiseAbs()).cwiseMax((a + edge_c).cwiseAbs());
  hit.error = plane_error(hit.face_normal, greatest, edge_b, edge_c);
  hit.normal = interpolate(mesh.normals, corners, b, c).stableNormalized();
  hit.tangent = interpolate(mesh.tangents, corners, b, c);
  hit.uv = interpolate(mesh.uvs, corners, b, c);
  const UvGradients gradients = uv_gradients(mesh, triangle);
  hit.dpdu = gradients.dpdu;
  hit.dpdv = gradients.dpdv;
  return hit;
}

}  // namespace mica::host
