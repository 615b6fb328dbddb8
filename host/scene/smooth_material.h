#pragma once

#include <Eigen/Core>
#include <optional>

#include "host/microfacet/visible_normals.h"
#include "host/scene/coat.h"
#include "host/scene/description.h"

namespace mica::host {

/// A material's lobes without glints: what needs no P-NDF (diffuse, a coat's own reflection), and with them,
/// where light bounces between shapes, a Beckmann lobe with the roughness of the whole map. All directions
/// are unit and in the tangent frame, views above the horizon.
class SmoothMaterial {
 public:
  enum class Lobes { without_normals, with_smooth_normals };

  /// @param alpha Beckmann roughness of the map and of the material's own. All must outlive this.
  SmoothMaterial(const MaterialDescription& material, const std::optional<CoatInterface>& coat, double alpha,
                 Lobes lobes);

  /// Whether there is any lobe at all.
  bool is_black() const { return !(diffuse_weight_ + coat_weight_ + normals_weight_ > 0); }

  /// f_r max(i.g, 0); zero for directions below the horizon. [Yan14] Eq. 1 with a smooth D.
  Color value(const Eigen::Vector3d& view, const Eigen::Vector3d& light) const;

  /// A direction for three uniform numbers in [0, 1). It may lie below the horizon: light is lost there.
  Eigen::Vector3d sample(const Eigen::Vector3d& view, const Eigen::Vector3d& uniform) const;

  /// With which `sample` draws a direction, per steradian.
  double pdf(const Eigen::Vector3d& view, const Eigen::Vector3d& light) const;

 private:
  const MaterialDescription& material_;
  const std::optional<CoatInterface>& coat_;
  double alpha_;
  double diffuse_weight_, coat_weight_, normals_weight_;  // in proportion to which lobes are drawn from
  VisibleNormals coat_normals_, normals_;
};

}  // namespace mica::host
