#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <optional>

#include "host/base/glints.h"

namespace mica::host {

/// A Gaussian pixel footprint in texture space: mean in uv (one map period is [0,1)^2, repeat outside) and
/// covariance in uv^2 units, symmetric positive definite. [Yan14] sec. 3.
struct Footprint {
  Eigen::Vector2d mean_uv = Eigen::Vector2d::Zero();
  Eigen::Matrix2d cov_uv = Eigen::Matrix2d::Identity();
};

/// One question to an evaluator: a Gaussian over place and half vector. With footprint G_p of mean c and
/// covariance C, half vector h at c, its turn H and the lobe's covariance S,
///   D = integral of G_p(u) G2(n(u) - h - H (u - c); S) du over the plane.
/// Without turn and with S = roughness^2 I it is the P-NDF density D(h) of the footprint. [Yan14] Eq. 6.
struct Query {
  Footprint footprint;
  Eigen::Vector2d half_vector =
      Eigen::Vector2d::Zero();  ///< (s, t) on the unit disk, tangent frame of the map
  double roughness = 0.01;      ///< standard deviation of the intrinsic Gaussian on the disk
  Eigen::Matrix2d half_vector_turn =
      Eigen::Matrix2d::Zero();  ///< d(s, t) / d(u, v), per unit of uv: how the half vector changes with place
  std::optional<Eigen::Matrix2d> lobe_cov = std::nullopt;  ///< on the disk; replaces `roughness`
};

/// Covariance of a query's lobe on the disk.
inline Eigen::Matrix2d lobe_covariance(const Query& query) {
  if (query.lobe_cov) return *query.lobe_cov;
  return query.roughness * query.roughness * Eigen::Matrix2d::Identity();
}

/// Whether a query's half vector turns over its footprint, or its lobe is not round.
inline bool has_first_order(const Query& query) {
  if (!query.half_vector_turn.isZero(0)) return true;
  if (!query.lobe_cov) return false;
  const Eigen::Matrix2d& lobe = *query.lobe_cov;
  return lobe(0, 1) != 0 || lobe(1, 0) != 0 || lobe(0, 0) != lobe(1, 1);
}

/// The same query, with a lobe that is wider by a variance along every axis.
inline Query with_wider_lobe(Query query, double variance) {
  if (query.lobe_cov)
    *query.lobe_cov += variance * Eigen::Matrix2d::Identity();
  else
    query.roughness = std::sqrt(query.roughness * query.roughness + variance);
  return query;
}

/// The same query, with a scalar roughness where the lobe is round.
inline Query with_scalar_roughness(Query query) {
  if (!query.lobe_cov || has_first_order(query)) return query;
  query.roughness = std::sqrt((*query.lobe_cov)(0, 0));
  query.lobe_cov.reset();
  return query;
}

/// One question to a patch BRDF: how a footprint scatters light from `light` (i) to `view` (o). Directions
/// are unit and in the tangent frame of the map, z along the geometric normal g.
struct BrdfQuery {
  Footprint footprint;
  Eigen::Vector3d view = Eigen::Vector3d::UnitZ(), light = Eigen::Vector3d::UnitZ();
  double roughness = 0.01;  ///< standard deviation of the intrinsic Gaussian on the disk
  std::optional<GlintPoint> glints = std::nullopt;  ///< for "grid": what they are here; none: as it says
};

/// One question about all light that a footprint scatters to `view`.
struct ViewQuery {
  Footprint footprint;
  Eigen::Vector3d view = Eigen::Vector3d::UnitZ();
  double roughness = 0.01;
  std::optional<GlintPoint> glints = std::nullopt;
};

/// A direction to be drawn.
struct SampleQuery {
  ViewQuery from;
  std::uint64_t key = 0;  ///< all random numbers of this draw are a hash of it
};

}  // namespace mica::host
