#pragma once

#include <Eigen/Geometry>

#include "host/scene/description.h"
#include "host/scene/hit.h"

namespace mica::host {

/// From the coordinates in which a shape is described to those of the scene, and back.
class PlacedFrame {
 public:
  /// @param origin of the shape's coordinates, where it is described.
  /// Throws UsageError for scales that are not positive, and for what is not finite.
  explicit PlacedFrame(const Placement& placement, const Eigen::Vector3d& origin = {0, 0, 0});

  bool is_identity() const { return is_identity_; }
  const Eigen::Affine3d& to_scene() const { return to_scene_; }

  /// The ray as the shape sees it, with the same parameter t.
  Ray to_shape(const Ray& ray) const;
  /// The hit as the scene sees it, of which `middle` is the origin for single precision.
  Hit to_scene(Hit hit, const Eigen::Vector3d& middle) const;

 private:
  bool is_identity_;
  Eigen::Affine3d to_scene_, to_shape_;
  Eigen::Matrix3d normal_to_scene_;  ///< inverse transposed
};

}  // namespace mica::host
