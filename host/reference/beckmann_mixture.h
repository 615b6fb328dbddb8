#pragma once

#include <Eigen/Core>
#include <vector>

#include "host/base/query.h"
#include "host/surface/surface.h"

namespace mica::host::reference {

/// A Gaussian of slopes and its share of a footprint.
struct SlopeLobe {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  double weight = 0;
};

/// [Che18]'s mixture of Beckmann lobes in double precision: plain sums over every element under a footprint.
///
/// Elements lie as those of GaussianMixture. A lobe has the moments of the slopes of the bilinear map under
/// its position kernel, by 6 points of Gauss-Legendre a spacing and axis, blurred by the roughness: a
/// Gaussian on the disk, of which slopes see the linear part at the lobe's mean. Weights are Gaussians of the
/// footprint's covariance less the kernel's, along each axis no less than the kernel's, divided by their sum.
/// Thread-safe.
class BeckmannMixture {
 public:
  /// Fits all lobes, in parallel.
  BeckmannMixture(const Surface& surface, int elements);

  /// Lobes of a footprint, roughness included, that weigh more than 1e-12 of the heaviest.
  std::vector<SlopeLobe> lobes(const Footprint& footprint, double roughness) const;

  /// D_P(h). [Che18] Eq. 9. @param half_vector on the disk.
  static double density(const std::vector<SlopeLobe>& lobes, const Eigen::Vector2d& half_vector);

  /// Integral of <o, w> D_P(w) over the hemisphere, in closed form: the denominator of [Che18] Eqs. 11-13.
  /// @param direction unit, above the horizon.
  static double visible_area(const std::vector<SlopeLobe>& lobes, const Eigen::Vector3d& direction);

  /// A_P(w), of [Che18] Eq. 17 without the clamps of single lobes: what the patch's mean normal shows a
  /// direction, >= 0.
  static double projected_area(const std::vector<SlopeLobe>& lobes, const Eigen::Vector3d& direction);

  /// F G2 D / (4 A_P(o)) without Fresnel's factor F: radiance to `view` by unit radiance from `light`, a
  /// steradian. G2 = G1(o) G1(i), [Che18] Eq. 16. @param view, light unit, above the horizon.
  static double scattering(const std::vector<SlopeLobe>& lobes, const Eigen::Vector3d& view,
                           const Eigen::Vector3d& light);

 private:
  long width_, height_;  // elements
  double corner_;        // where element (0, 0) is, in elements
  std::vector<SlopeLobe> fitted_;
};

}  // namespace mica::host::reference
