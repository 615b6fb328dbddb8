#pragma once

#include <Eigen/Core>

#include "host/base/glints_description.h"
#include "host/microfacet/visible_normals.h"

namespace mica::host {

/// A lobe of normals about +z: what a map, or a process of glints, is from so far away that no glint is told
/// from another. All directions are unit and in the tangent frame.
class SmoothLobe {
 public:
  using Masking = GlintsDescription::Masking;

  /// @param slope_moments second moments of the slopes about 0, positive semidefinite: half the square of
  /// alpha along its axes, also of Trowbridge-Reitz lobes, which have none. Narrower lobes than of an alpha
  /// of 1e-3, which no draw towards a light meets, are widened to it.
  SmoothLobe(Distribution distribution, const Eigen::Matrix2d& slope_moments, Masking masking);
  /// Round, of Beckmann's kind with Smith's masking.
  SmoothLobe(double alpha)
      : SmoothLobe(Distribution::beckmann, alpha * alpha / 2 * Eigen::Matrix2d::Identity(), Masking::smith) {}
  /// Of glints with a roughness of `alpha` along u and v.
  SmoothLobe(const GlintsDescription& glints, const Eigen::Vector2d& alpha);

  /// D(h), a density over the disk. @param half above the horizon.
  double density(const Eigen::Vector3d& half) const;

  /// G(o, i), see glint_masking. @param view, light above the horizon.
  double masking_shadowing(const Eigen::Vector3d& view, const Eigen::Vector3d& light) const;

  /// Draws of its normals: of a Trowbridge-Reitz lobe with its roughness.
  const VisibleNormals& visible_normals() const { return visible_normals_; }

  /// The slope of a normal: normals that are drawn with uniform numbers have D as their density on the disk.
  Eigen::Vector2d slope(const Eigen::Vector2d& uniform) const;

  /// Without the part of a roughness, standard deviations on the disk along u and v, that was added to its
  /// slopes.
  SmoothLobe narrowed(const Eigen::Vector2d& roughness) const;

  /// Roughness of a round lobe with the same mean square slope.
  double mean_alpha() const;

  bool operator==(const SmoothLobe& other) const;

 private:
  Distribution distribution_;
  Masking masking_;
  Eigen::Matrix2d slope_moments_;
  Eigen::Matrix2d axes_;    // columns: where the roughness is smallest and greatest
  Eigen::Vector2d alphas_;  // roughness along them
  VisibleNormals visible_normals_;
};

}  // namespace mica::host
