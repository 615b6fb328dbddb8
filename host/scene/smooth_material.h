#pragma once

#include <Eigen/Core>

#include "host/scene/description.h"
#include "host/scene/visible_normals.h"

namespace mica {

/// What a material is to light that bounces between shapes: a Beckmann lobe with the roughness of the whole
/// map, and the diffuse lobe. All directions are unit and in the tangent frame.
class SmoothMaterial {
 public:
  /// @param alpha Beckmann roughness of the map and of the material's own.
  SmoothMaterial(const MaterialDescription& material, double alpha);

  /// f_r max(i.g, 0); zero for directions below the horizon. [Yan14] Eq. 1 with a smooth D.
  Color value(const Eigen::Vector3d& view, const Eigen::Vector3d& light) const;

  /// A direction for three uniform numbers in [0, 1). It may lie below the horizon: light is lost there.
  Eigen::Vector3d sample(const Eigen::Vector3d& view, const Eigen::Vector3d& uniform) const;

  /// With which `sample` draws a direction, per steradian.
  double pdf(const Eigen::Vector3d& view, const Eigen::Vector3d& light) const;

 private:
  /// Share of the draws that the diffuse lobe takes.
  double diffuse_share(const Eigen::Vector3d& view) const;

  const MaterialDescription& material_;
  double alpha_;
  VisibleNormals normals_;
};

}  // namespace mica
