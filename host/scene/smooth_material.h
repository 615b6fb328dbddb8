#pragma once

#include <Eigen/Core>
#include <optional>

#include "host/microfacet/smooth_lobe.h"
#include "host/scene/layered_material.h"

namespace mica::host {

/// What mirrors, where glints are not told from each other.
struct SmoothNormals {
  SmoothLobe lobe;
  Color tint;  ///< mean colour of glints; 1 of maps
};

/// A material's lobes without glints: what needs no P-NDF (diffuse, a coat's own reflection), and with them,
/// where light bounces between shapes, a smooth lobe for all of its glints. All directions are unit and in
/// the tangent frame, views above the horizon.
class SmoothMaterial {
 public:
  /// @param normals none: only what needs no P-NDF. @param layers must outlive this.
  explicit SmoothMaterial(const LayeredMaterial& layers, std::optional<SmoothNormals> normals = {});

  /// Whether there is any lobe at all.
  bool is_black() const { return !(diffuse_weight_ + coat_weight_ + normals_weight_ > 0); }

  /// f_r max(i.g, 0); zero for directions below the horizon. [Yan14] Eq. 1 with a smooth D.
  Color value(const Eigen::Vector3d& view, const Eigen::Vector3d& light) const;

  /// A direction for three uniform numbers in [0, 1). It may lie below the horizon: light is lost there.
  Eigen::Vector3d sample(const Eigen::Vector3d& view, const Eigen::Vector3d& uniform) const;

  /// With which `sample` draws a direction, per steradian.
  double pdf(const Eigen::Vector3d& view, const Eigen::Vector3d& light) const;

 private:
  const LayeredMaterial& layers_;
  std::optional<SmoothNormals> normals_;
  double diffuse_weight_, coat_weight_, normals_weight_;  // in proportion to which lobes are drawn from
  VisibleNormals coat_normals_;
};

}  // namespace mica::host
