#include "host/render/lit_normals.h"

#include <cmath>

#include "host/methods/triangles/triangle_precision.h"

namespace mica::host {

LitNormals::LitNormals(const Surface& surface)
    : bounds_(surface),
      lobe_variance_(surface.lobe_variance()),
      cutoff_(triangle_precision(kExactTriangles).cutoff) {}

bool LitNormals::may_answer(const Query& query) const {
  constexpr double slack = 1e-4;  // of the disk: normals and their bounds are rounded
  const Eigen::Matrix2d& cov = query.footprint.cov_uv;
  const Eigen::Vector2d reach = (cutoff_ * cov.diagonal()).cwiseMax(0).cwiseSqrt();
  const NormalBounds::Box box = bounds_.within(query.footprint.mean_uv, reach);
  const Eigen::Vector2d distance =
      ((box.min() - query.half_vector).cwiseMax(query.half_vector - box.max()).array() - slack).max(0);
  // Of the sum of both exponents, over all places u, a normal m leaves (m - h)' (S + H C H')^-1 (m - h).
  const Eigen::Matrix2d spread = lobe_covariance(query) + lobe_variance_ * Eigen::Matrix2d::Identity() +
                                 query.half_vector_turn * cov * query.half_vector_turn.transpose();
  const double half_trace = spread.trace() / 2;
  const double largest = half_trace + std::hypot(spread(0, 0) - half_trace, spread(0, 1));
  return !((distance.array().square() > cutoff_ * spread.diagonal().array()).any() ||
           distance.squaredNorm() > cutoff_ * largest);
}

}  // namespace mica::host
