#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace mica::host {

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

/// One question to a patch BRDF: how a footprint scatters light from `light` (i) to `view` (o). Directions
/// are unit and in the tangent frame of the map, z along the geometric normal g.
struct BrdfQuery {
  Footprint footprint;
  Eigen::Vector3d view = Eigen::Vector3d::UnitZ(), light = Eigen::Vector3d::UnitZ();
  double roughness = 0.01;  ///< standard deviation of the intrinsic Gaussian on the disk
};

/// One question about all light that a footprint scatters to `view`.
struct ViewQuery {
  Footprint footprint;
  Eigen::Vector3d view = Eigen::Vector3d::UnitZ();
  double roughness = 0.01;
};

/// A direction to be drawn.
struct SampleQuery {
  ViewQuery from;
  std::uint64_t key = 0;  ///< all random numbers of this draw are a hash of it
};

}  // namespace mica::host
