#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "host/scene/camera.h"
#include "host/scene/description.h"
#include "host/scene/mesh.h"

namespace mica::host {

/// origin + t * direction; the direction may have any length.
struct Ray {
  Eigen::Vector3d origin, direction;
};

/// Where a ray meets a shape. Derivatives are those of the tangent plane, in world units per unit of uv.
struct Hit {
  double t = 0;
  double error = 0;  ///< distance along the normal by which single precision may misplace the surface here
  Eigen::Vector3d position;
  Eigen::Vector3d face_normal;  ///< normal of the plane in which position, dpdu and dpdv lie; unit
  Eigen::Vector3d normal;       ///< smooth over the shape; unit
  Eigen::Vector3d tangent;      ///< smooth over the shape, towards +u; of any length, may be zero
  Eigen::Vector3d dpdu, dpdv;   ///< zero where uv is degenerate
  Eigen::Vector2d uv;           ///< texture coordinates of the shape, before the material's repeat
  std::uint32_t shape = 0;      ///< index into SceneDescription::shapes
  std::uint32_t part = 0;       ///< which part of the shape was hit, by Geometry::parts
};

/// From a hit, on the side of the surface to which it points.
struct ShadowRay {
  Eigen::Vector3d direction;  ///< unit
  double distance;
};

/// What is left of a number after some 30 roundings to single precision.
constexpr double kRelativeError = 4e-6;

// The exact point at which a ray meets a shape that single precision has already found to be the first:
// texture coordinates are needed to 1e-6 of a map, which a float hit does not give.

Hit hit_plane(const PlaneShape& plane, const Ray& ray);

/// @param t_near the approximate ray parameter, which tells the two intersections apart.
Hit hit_sphere(const SphereShape& sphere, const Ray& ray, double t_near);

Hit hit_triangle(const TriangleMesh& mesh, std::uint32_t triangle, const Ray& ray);

}  // namespace mica::host
