#pragma once

#include <Eigen/Core>

namespace mica::host {

/// A Trowbridge-Reitz lobe of normals about +z, from which reflected directions are drawn by how much of each
/// normal the view sees. Its tails are longer than those of any Gaussian of slopes of the same moments, so
/// that densities in proportion to it stay bounded: by 4/e for a Beckmann lobe of the same roughness.
class VisibleNormals {
 public:
  /// @param slope_moments second moments of the slopes about 0; positive definite.
  explicit VisibleNormals(const Eigen::Matrix2d& slope_moments);

  /// A unit half vector. J. Dupuy and A. Benyoub, "Sampling Visible GGX Normals with Spherical Caps" (2023),
  /// listing 3.
  /// @param view unit, above the horizon.
  Eigen::Vector3d sample(const Eigen::Vector3d& view, const Eigen::Vector2d& uniform) const;

  /// With which mirroring the view at a drawn normal gives a direction, per steradian: G1(o) D(h) / (4 o.z).
  /// E. Heitz, "Sampling the GGX Distribution of Visible Normals" (2018), Eqs. 1 to 3 and 17.
  /// @param half unit, between the view and that direction.
  double pdf(const Eigen::Vector3d& view, const Eigen::Vector3d& half) const;

 private:
  Eigen::Matrix2d axes_;    // columns: where the roughness is smallest and greatest
  Eigen::Vector2d alphas_;  // roughness along them
};

}  // namespace mica::host
