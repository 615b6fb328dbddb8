#include "host/microfacet/smooth_lobe.h"

#include <cmath>

#include "host/base/constants.h"
#include "host/base/symmetric_matrix.h"
#include "host/microfacet/glint_masking.h"

namespace mica::host {
namespace {

constexpr double kLeastAlpha = 1e-3;

Eigen::Matrix2d moments_of(const Eigen::Vector2d& alpha) {
  return (alpha.cwiseAbs2() / 2).asDiagonal();
}

}  // namespace

SmoothLobe::SmoothLobe(Distribution distribution, const Eigen::Matrix2d& slope_moments, Masking masking)
    : distribution_(distribution),
      masking_(masking),
      slope_moments_(slope_moments),
      axes_(principal_axes_directly(slope_moments).eigenvectors),
      alphas_((2 * principal_axes_directly(slope_moments).eigenvalues)
                  .cwiseMax(kLeastAlpha * kLeastAlpha)
                  .cwiseSqrt()),
      visible_normals_(axes_ * moments_of(alphas_) * axes_.transpose()) {}

SmoothLobe::SmoothLobe(const GlintsDescription& glints, const Eigen::Vector2d& alpha)
    : SmoothLobe(glints.distribution, moments_of(alpha), glints.masking) {}

double SmoothLobe::density(const Eigen::Vector3d& half) const {
  const double cos2 = half.z() * half.z();
  const double stretched2 = (axes_.transpose() * half.head<2>()).cwiseQuotient(alphas_).squaredNorm() /
                            cos2;  // a slope's, in alphas
  const double scale = 1 / (kPi * alphas_.prod() * cos2 * cos2);
  if (distribution_ == Distribution::beckmann) return scale * std::exp(-stretched2);  // [Heitz14] Eq. 85
  return scale / ((1 + stretched2) * (1 + stretched2));                               // [Heitz14] Eq. 86
}

double SmoothLobe::masking_shadowing(const Eigen::Vector3d& view, const Eigen::Vector3d& light) const {
  const auto along_axes = [&](const Eigen::Vector3d& direction) {
    const Eigen::Vector2d across = axes_.transpose() * direction.head<2>();
    return Eigen::Vector3d(across.x(), across.y(), direction.z());
  };
  return glint_masking(distribution_, masking_, alphas_, along_axes(view), along_axes(light));
}

Eigen::Vector2d SmoothLobe::slope(const Eigen::Vector2d& uniform) const {
  const double radius2 =
      distribution_ == Distribution::beckmann ? -std::log1p(-uniform.x()) : uniform.x() / (1 - uniform.x());
  const double turn = 2 * kPi * uniform.y();
  return axes_ * alphas_.cwiseProduct(std::sqrt(radius2) * Eigen::Vector2d(std::cos(turn), std::sin(turn)));
}

SmoothLobe SmoothLobe::narrowed(const Eigen::Vector2d& roughness) const {
  Eigen::Matrix2d moments = slope_moments_;
  moments.diagonal() -= roughness.cwiseAbs2();
  return SmoothLobe(distribution_, moments, masking_);
}

double SmoothLobe::mean_alpha() const {
  return std::sqrt(slope_moments_.trace());
}

bool SmoothLobe::operator==(const SmoothLobe& other) const {
  return distribution_ == other.distribution_ && masking_ == other.masking_ &&
         slope_moments_ == other.slope_moments_;
}

}  // namespace mica::host
