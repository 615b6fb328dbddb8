#include "host/reference/glint_draws.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "host/base/constants.h"
#include "host/base/symmetric_matrix.h"

namespace mica::host::reference {
namespace {

constexpr double kUniformShare = 0.125;

double normal_share(double low, double high, double mean, double sigma) {
  const auto cdf = [](double x) { return 0.5 * std::erfc(-x / std::sqrt(2.0)); };
  return cdf((high - mean) / sigma) - cdf((low - mean) / sigma);
}

double normal_density(double x, double mean, double sigma) {
  return std::exp(-0.5 * std::pow((x - mean) / sigma, 2)) / (sigma * std::sqrt(2 * kPi));
}

double roulette(double r, double weight) {  // [Kem25] Eq. 8
  const double low = std::max(0.0, r - 0.1), high = std::min(1.0, r + 0.1);
  const double t = std::clamp((weight - low) / (high - low), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

/// A level of a query, in cells.
struct Level {
  Eigen::Vector2d position, angle;
  Eigen::Matrix2d precision;
  int level;
  double weight;
};

/// Density at level.angle, per area of the unit square.
double level_density(const GlintProcess& process, double microroughness, const Level& at) {
  const double cells = std::exp2(at.level), root = std::sqrt(process.stretch);
  const auto lowest = [](double x) { return static_cast<std::int64_t>(std::floor(x - 0.5)); };
  const std::int64_t k0 = lowest(at.angle.x()), l0 = lowest(at.angle.y());
  const Eigen::Vector2d lowest_cell(k0, l0);
  const Eigen::Vector2d low = (lowest_cell.array() + 0.5).max(0),
                        high = (lowest_cell.array() + 1.5).min(cells);
  double mass = 0, density = 0;
  for (int n = 0; n < 16; ++n) {
    const std::int64_t i = lowest(at.position.x()) + (n & 1), j = lowest(at.position.y()) + (n >> 1 & 1);
    const std::int64_t k = k0 + (n >> 2 & 1), l = l0 + (n >> 3);
    const Glint glint = glint_of_cell(i, j, k, l, at.level, process.seed);
    const Eigen::Vector2d mu = Eigen::Vector2d(k, l) + glint.angle;
    if ((mu / cells - Eigen::Vector2d(0.5, 0.5)).norm() >= 0.5) continue;
    const Eigen::Vector2d d = Eigen::Vector2d(i, j) + glint.place - at.position;
    const double strength = std::exp(-0.5 * d.dot(at.precision * d)) * roulette(glint.roulette, at.weight);
    const double jacobian = kPi / 4 * process.smooth_density(process.from_disk(mu / cells));
    const Eigen::Vector2d sigma =
        microroughness * std::sqrt(jacobian) * cells * Eigen::Vector2d(1 / root, root);
    double share = strength, lobe = strength;
    for (int axis = 0; axis < 2; ++axis) {
      share *= normal_share(low[axis], high[axis], mu[axis], sigma[axis]);
      lobe *= normal_density(at.angle[axis], mu[axis], sigma[axis]);
    }
    mass += share, density += lobe;
  }
  // The region is drawn as that of a point of the square.
  return mass > 1e-5 ? (high - low).prod() * density / mass : 1;
}

}  // namespace

double glint_draw_density(const GlintProcess& process, const Query& query) {
  const double smooth = process.smooth_density(query.half_vector);
  const double resolution = std::sqrt(process.density), root = std::sqrt(process.stretch);
  const Eigen::DiagonalMatrix<double, 2> to_cells(resolution / root, resolution * root);
  Eigen::Matrix2d covariance = to_cells * query.footprint.cov_uv * to_cells;
  const double sigma2 = principal_axes(covariance).eigenvalues[1];
  const double detail = std::clamp(std::log2(8 * std::sqrt(std::max(sigma2, 1e-100))), 0.0, 24.0);
  const int finer = static_cast<int>(detail);
  covariance += std::pow(std::exp2(finer) / 128, 2) * Eigen::Matrix2d::Identity();
  double sum = kUniformShare * 4 / kPi;
  for (int n = 0; n < 2; ++n) {
    const double cells = std::exp2(finer + n);
    Level level;
    level.level = finer + n;
    level.weight = n == 0 ? 1 - (detail - finer) : detail - finer;
    level.position = to_cells * query.footprint.mean_uv / cells;
    level.angle = process.to_disk(query.half_vector) * cells;
    level.precision = (covariance / (cells * cells)).inverse();
    sum += (1 - kUniformShare) * level.weight * level_density(process, query.roughness, level);
  }
  return kPi / 4 * smooth * sum;
}

}  // namespace mica::host::reference
