#pragma once

#include <Eigen/Core>
#include <vector>

#include "host/scene/description.h"
#include "host/scene/hit.h"

namespace mica::host {

/// Orthonormal; z towards the eye, x along +u, y on the side of +v (see Scene).
struct TangentFrame {
  Eigen::Vector3d x, y, z;
  Eigen::Vector3d face_normal;  ///< normal of the actual surface, towards the eye

  Eigen::Vector2d on_disk(const Eigen::Vector3d& direction) const {
    return {direction.dot(x), direction.dot(y)};
  }
  Eigen::Vector3d to_local(const Eigen::Vector3d& direction) const {
    return {direction.dot(x), direction.dot(y), direction.dot(z)};
  }
  Eigen::Vector3d to_world(const Eigen::Vector3d& local) const {
    return local.x() * x + local.y() * y + local.z() * z;
  }
};
/// @param to_eye unit.
TangentFrame tangent_frame(const Hit& hit, const Eigen::Vector3d& to_eye);

/// Light that arrives at a point from one light, before any shadow.
struct Illumination {
  Eigen::Vector3d direction;  ///< towards the light's middle; unit
  double distance;            ///< to the light; infinite for directional ones
  Color irradiance;           ///< on a surface that faces the light
  double variance = 0;        ///< variance an axis of the directions in which the light is seen, radians^2
  Eigen::Matrix3d cov = Eigen::Matrix3d::Zero();  ///< of these directions, across the middle one
};
Illumination illuminate(const LightDescription& light, const Eigen::Vector3d& position);

/// The same light cut into `rings` about its middle, see disk_cells, each part with a direction and a spread
/// of its own. Their sum is as bright as the whole on a surface that faces it. Lights without extent are one
/// part.
/// @param whole as illuminate has it, with an irradiance above 0.
std::vector<Illumination> illuminate_by_parts(const LightDescription& light, const Eigen::Vector3d& position,
                                              const Illumination& whole, int rings);

/// Whether a light is more than a point or a direction, so that its shadows have penumbras.
bool has_extent(const LightDescription& light);

/// Whether its extent widens lobes: of a directional light an angular radius does, too.
bool widens_lobes(const LightDescription& light);

/// The shadow rays from a place to a light.
class ShadowRays {
 public:
  ShadowRays(const LightDescription& light, const Eigen::Vector3d& position);
  /// @param on_disk of the unit disk, which stands for the light's; of lights without extent all rays are
  /// one.
  ShadowRay to(const Eigen::Vector2d& on_disk) const;

 private:
  Eigen::Vector3d middle_, x_, y_;  // from the place
  bool is_far_;
};

/// By how much a light's extent spreads the half vector on the disk, an axis: what it adds to the square of a
/// query's roughness.
///
/// The half vector turns half as far as the light in the plane of both directions, and 1 / (2 cos_d) as far
/// across it; a Gaussian of the mean of both variances stands for the light's disk.
/// @param cos_d cosine between light and half vector.
double half_vector_variance(double light_variance, double cos_d);

}  // namespace mica::host
