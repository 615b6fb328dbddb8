#pragma once

#include <Eigen/Core>
#include <cmath>

namespace mica::host {

/// Farthest that a stored normal may lie from the centre of the disk: 89.2 degrees off the geometric normal.
/// Beyond it the slope, and with it every Jacobian, loses its meaning.
constexpr double kRim = 0.9999;

/// Projection on the unit disk of the normal that belongs to slope (p, q) = (-n_x / n_z, -n_y / n_z). [Che18]
/// sec. 3.
inline Eigen::Vector2d disk_from_slope(const Eigen::Vector2d& slope) {
  return -slope / std::sqrt(1 + slope.squaredNorm());
}

/// Inverse of disk_from_slope, for |s| < 1.
inline Eigen::Vector2d slope_from_disk(const Eigen::Vector2d& s) {
  return -s / std::sqrt(1 - s.squaredNorm());
}

}  // namespace mica::host
