#pragma once

#include <Eigen/Core>

namespace mica {

/// A Gaussian pixel footprint in texture space: mean in uv (one map period is [0,1)^2, repeat outside) and
/// covariance in uv^2 units, symmetric positive definite. [Yan14] sec. 3.
struct Footprint {
  Eigen::Vector2d mean_uv = Eigen::Vector2d::Zero();
  Eigen::Matrix2d cov_uv = Eigen::Matrix2d::Identity();
};

/// One question to an evaluator: the P-NDF density D(s) of a footprint. [Yan14] Eq. 6.
struct Query {
  Footprint footprint;
  Eigen::Vector2d half_vector =
      Eigen::Vector2d::Zero();  ///< (s, t) on the unit disk, tangent frame of the map
  double roughness = 0.01;      ///< standard deviation of the intrinsic Gaussian on the disk
};

}  // namespace mica
