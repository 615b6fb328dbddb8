#include "host/reference/query_frame.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/base/constants.h"
#include "mica/error.h"

namespace mica::host::reference {
namespace {

/// a c - b^2 without cancellation: elongated footprints have determinants far smaller than either product.
double determinant(double a, double b, double c) {
  const double b_squared = b * b;
  return std::fma(a, c, -b_squared) + std::fma(-b, b, b_squared);
}

void require(bool holds, const char* what) {
  if (!holds) throw UsageError(what);
}

/// The sum of G_p over all periods is (1 + ripple) / (W H), where the ripple is the sum of exp(-2 kPi^2 k^T C
/// k) over the integer vectors k != 0 (Poisson summation, C in uv). At most 8 exp(-2 kPi^2 e) where C's
/// smaller eigenvalue e > 0.1.
bool ripple_below(double bound, double cuu, double det, double cvv) {
  const double half_trace = 0.5 * (cuu + cvv);
  const double larger = half_trace + std::sqrt(std::max(0.0, half_trace * half_trace - det));
  const double smaller = det / larger;
  return smaller > 0.1 && 8 * std::exp(-2 * kPi * kPi * smaller) <= bound;
}

}  // namespace

/// @return the square root of the determinant of the lobe's covariance.
double QueryFrame::set_lobe(const Query& query) {
  if (!query.lobe_cov) {
    whiten_lobe_ = Eigen::Matrix2d::Identity() * (1 / query.roughness);
    return query.roughness * query.roughness;
  }
  const Eigen::Matrix2d& lobe = *query.lobe_cov;
  require(lobe.allFinite() && lobe(0, 1) == lobe(1, 0), "the lobe's covariance is not finite and symmetric");
  const double det = determinant(lobe(0, 0), lobe(0, 1), lobe(1, 1));
  require(lobe(0, 0) > 0 && det > 0, "the lobe's covariance is not positive definite");
  const double sigma_s = std::sqrt(lobe(0, 0)), sigma_t = std::sqrt(det / lobe(0, 0));
  whiten_lobe_ << 1 / sigma_s, 0, -lobe(0, 1) / (lobe(0, 0) * sigma_t), 1 / sigma_t;
  return std::sqrt(det);
}

QueryFrame::QueryFrame(const Surface& surface, const Query& query, double negligible) {
  const Eigen::Matrix2d& cov = query.footprint.cov_uv;
  require(query.footprint.mean_uv.allFinite(), "the footprint's mean is not finite");
  require(cov.allFinite() && cov(0, 1) == cov(1, 0),
          "the footprint's covariance is not finite and symmetric");
  require(query.half_vector.allFinite(), "the half vector is not finite");
  require(query.half_vector_turn.allFinite(), "the turn of the half vector is not finite");
  require(query.lobe_cov || (std::isfinite(query.roughness) && query.roughness > 0),
          "the roughness is not positive and finite");
  const double det = determinant(cov(0, 0), cov(0, 1), cov(1, 1));
  require(cov(0, 0) > 0 && det > 0, "the footprint's covariance is not positive definite");

  const double width = surface.width(), height = surface.height();
  const Eigen::Vector2d& mean = query.footprint.mean_uv;
  mean_texels_ = {(mean.x() - std::floor(mean.x())) * width, (mean.y() - std::floor(mean.y())) * height};
  cov_texels_ << cov(0, 0) * width * width, cov(0, 1) * width * height, cov(0, 1) * width * height,
      cov(1, 1) * height * height;
  half_vector_ = query.half_vector;
  const bool turns = !query.half_vector_turn.isZero(0);
  covers_evenly_ = !turns && ripple_below(negligible, cov(0, 0), det, cov(1, 1));

  const double sigma_x = std::sqrt(cov(0, 0)) * width;
  const double sigma_y = std::sqrt(det / cov(0, 0)) * height;
  inverse_x_ = covers_evenly_ ? 0 : 1 / sigma_x;
  inverse_y_ = covers_evenly_ ? 0 : 1 / sigma_y;
  shear_ = cov(0, 1) / std::sqrt(cov(0, 0)) * height;
  const double footprint_area = covers_evenly_ ? width * height : 2 * kPi * sigma_x * sigma_y;
  effective_area_ = covers_evenly_ ? footprint_area : footprint_area + 1;
  const double lobe_sigma_2 = set_lobe(query);
  scale_ = 1 / (footprint_area * 2 * kPi * lobe_sigma_2);
  Eigen::Matrix2d factor;  // of the footprint's covariance, in uv
  factor << sigma_x / width, 0, shear_ / height, sigma_y / height;
  whitened_turn_ =
      turns ? Eigen::Matrix2d(whiten_lobe_ * query.half_vector_turn * factor) : Eigen::Matrix2d::Zero();

  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  const double finest = std::min(sigma_x, sigma_y) / std::max(width, height);
  rounding_ = 8 * epsilon *
              (whiten_lobe_.cwiseAbs().maxCoeff() + 8 * whitened_turn_.cwiseAbs().maxCoeff() + 1 / finest);
  // Beyond, coordinates in double say nothing about D; far beyond, they overflow.
  require(rounding_ < 1e-3 && sigma_x < 1e9 && sigma_y < 1e9,
          "too small or too large a footprint or roughness");
}

/// Components of a sum are at least as far from 0 as the intervals that its terms span.
double QueryFrame::lobe_distance_squared(const NormalBox& box, const Eigen::Vector2d* corners,
                                         int count) const {
  const Eigen::Vector2d middle = whiten_lobe_ * (0.5 * (box.low + box.high) - half_vector_);
  const Eigen::Vector2d half = whiten_lobe_.cwiseAbs() * (0.5 * (box.high - box.low));
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (int k = 0; k < count; ++k) {
    const Eigen::Vector2d turned = middle - whitened_turn_ * corners[k];
    low = low.cwiseMin(turned), high = high.cwiseMax(turned);
  }
  return (low - half).cwiseMax(-high - half).cwiseMax(0.0).squaredNorm();
}

Eigen::Vector2d QueryFrame::whiten_position(const Eigen::Vector2d& position_texels) const {
  const Eigen::Vector2d offset = position_texels - mean_texels_;
  const double x = offset.x() * inverse_x_;
  return {x, (offset.y() - shear_ * x) * inverse_y_};
}

}  // namespace mica::host::reference
