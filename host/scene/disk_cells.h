#pragma once

#include <Eigen/Core>
#include <vector>

namespace mica::host {

/// A part of the unit disk, and of what is alike all over it, as a Gaussian of the part's mean and
/// covariance.
struct DiskCell {
  Eigen::Vector2d mean;
  Eigen::Matrix2d cov;
  double share;  ///< of the disk
};

constexpr int kMostRings = 8;
constexpr int cells_of(int rings) {
  return 1 + 3 * rings * (rings + 1);
}
constexpr int kMostLampParts = cells_of(kMostRings);

/// The disk as a middle disk and `rings` about it, 0..kMostRings, of 6, 12, ... sectors, all of one area. The
/// sum of their Gaussians has the disk's mean and covariance, and higher moments the better the more there
/// are.
const std::vector<DiskCell>& disk_cells(int rings);

/// The relative L2 by which that sum is off where both are seen through a Gaussian lobe: a law that holds to
/// 1.6 times where it says 0.001 to 0.03.
/// @param radius_lobes the disk's, in standard deviations of the lobe.
double error_of_cells(double radius_lobes, int rings);

/// How lamps with an extent are cut into parts, each a Gaussian.
struct LampParts {
  double tolerance = 0.01;  ///< relative L2 of what they show in a lobe
  int most_rings = 0;       ///< 0..kMostRings; 0: each lamp is one Gaussian

  /// @param most parts that a lamp may have, 1..kMostLampParts.
  static LampParts of(int most, double tolerance);
  /// The fewest rings that keep the tolerance, or the most.
  int rings(double radius_lobes) const;
};

}  // namespace mica::host
