#include "host/reference/gaussian_mixture.h"

#include <tbb/parallel_for.h>

#include <Eigen/LU>
#include <cmath>

namespace mica::host::reference {
namespace {

/// A centred Gaussian in the plane.
class Gaussian {
 public:
  explicit Gaussian(const Eigen::Matrix2d& cov)
      : inverse_(cov.inverse()), peak_(1 / (2 * M_PI * std::sqrt(cov.determinant()))) {}
  double operator()(const Eigen::Vector2d& x) const { return peak_ * std::exp(-0.5 * x.dot(inverse_ * x)); }

 private:
  Eigen::Matrix2d inverse_;
  double peak_;
};

}  // namespace

double GaussianMixture::evaluate(const Query& query) const {
  constexpr double reach = 8;  // standard deviations
  const double h = 1.0 / elements_;
  const Eigen::Matrix2d kernel = h * h / (8 * std::log(2.0)) * Eigen::Matrix2d::Identity();
  const Eigen::DiagonalMatrix<double, 2> texels(surface_.width(), surface_.height());
  const Eigen::Matrix2d footprint = texels * query.footprint.cov_uv * texels;
  const Eigen::Matrix2d both = footprint + kernel;
  const Eigen::Matrix2d pull = kernel * both.inverse();  // pulls the slice's mean towards the footprint's
  const Eigen::Matrix2d sliced = pull * footprint;       // covariance of the position, given both
  const bool constant_texels = surface_.interpolation() == Interpolation::nearest;
  const double corner = constant_texels ? 0 : 0.5;  // texel (0, 0) begins there, or its quad
  const Eigen::Vector2d mean = texels * query.footprint.mean_uv;

  const Eigen::Vector2d extent = reach * both.diagonal().cwiseSqrt();
  const long first_a = std::lround(std::floor((mean.x() - extent.x() - corner) / h)),
             last_a = std::lround(std::ceil((mean.x() + extent.x() - corner) / h)),
             first_b = std::lround(std::floor((mean.y() - extent.y() - corner) / h)),
             last_b = std::lround(std::ceil((mean.y() + extent.y() - corner) / h));
  const Gaussian position(both);
  const double negligible = 1e-12 * position(Eigen::Vector2d::Zero());
  double sum = 0, weights = 0;
  for (long b = first_b; b <= last_b; ++b) {
    for (long a = first_a; a <= last_a; ++a) {
      const double x = (a + 0.5) * h, y = (b + 0.5) * h;
      const Eigen::Vector2d offset = mean - Eigen::Vector2d(x + corner, y + corner);
      const double weight = position(offset);
      weights += weight;
      if (weight < negligible) continue;
      const long i = std::lround(std::floor(x)), j = std::lround(std::floor(y));
      const double f = x - static_cast<double>(i), g = y - static_cast<double>(j);
      Eigen::Vector2d normal = surface_.texel(i, j);
      Eigen::Matrix2d jacobian = Eigen::Matrix2d::Zero();
      if (!constant_texels) {
        const Eigen::Vector2d &n00 = surface_.texel(i, j), &n10 = surface_.texel(i + 1, j),
                              &n01 = surface_.texel(i, j + 1), &n11 = surface_.texel(i + 1, j + 1);
        normal = (1 - f) * (1 - g) * n00 + f * (1 - g) * n10 + (1 - f) * g * n01 + f * g * n11;
        jacobian << (1 - g) * (n10 - n00) + g * (n11 - n01), (1 - f) * (n01 - n00) + f * (n11 - n10);
      }
      const Eigen::Matrix2d spread = query.roughness * query.roughness * Eigen::Matrix2d::Identity() +
                                     jacobian * sliced * jacobian.transpose();
      sum += weight * Gaussian(spread)(query.half_vector - normal - jacobian * (pull * offset));
    }
  }
  return sum / weights;
}

std::vector<double> GaussianMixture::evaluate(const std::vector<Query>& queries) const {
  std::vector<double> densities(queries.size());
  tbb::parallel_for(std::size_t{0}, queries.size(),
                    [&](std::size_t n) { densities[n] = evaluate(queries[n]); });
  return densities;
}

}  // namespace mica::host::reference
