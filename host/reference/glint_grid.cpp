#include "host/reference/glint_grid.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "host/base/constants.h"
#include "host/base/symmetric_matrix.h"

namespace mica::host::reference {
namespace {

// kernels/grid/glint_hash.h, written again.
std::uint32_t mix(std::uint32_t x) {
  x = (x ^ (x >> 16)) * 0x7feb352du;
  x = (x ^ (x >> 15)) * 0x846ca68bu;
  return x ^ (x >> 16);
}
constexpr std::uint32_t kCellMask = 0x7fffffffu;

double smoothstep(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

double cdf(double x) {
  return 0.5 * std::erfc(-x / std::sqrt(2.0));
}

/// Integral of a normal density around `mean` over [low, high].
double share(double low, double high, double mean, double sigma) {
  return cdf((high - mean) / sigma) - cdf((low - mean) / sigma);
}

/// Lowest of the two cells that are nearest to x.
std::int64_t lowest_cell(double x) {
  return static_cast<std::int64_t>(std::floor(x - 0.5));
}

/// Everything of a query that does not depend on the level.
struct Problem {
  Eigen::Vector2d position;    ///< cells of level 0
  Eigen::Matrix2d covariance;  ///< cells^2 of level 0
  Eigen::Vector2d angle;       ///< on the unit square
  Eigen::Vector2d sigma_angle;
  std::uint32_t seed;
  double share, kept;
};

/// Whether a glint is there when a share of them is. The window of the soft step stays inside of (0, 1), so
/// that its mean over r is the share.
double presence(double r, double share) {
  const double softness = std::min({0.1, share, 1 - share});
  return softness > 1e-6 ? smoothstep(r - softness, r + softness, share) : (r < share ? 1 : 0);
}

void add_level(const Problem& problem, int level, double weight, std::vector<double>* densities) {
  const double cells = std::exp2(level);
  const Eigen::Vector2d position = problem.position / cells, angle = problem.angle * cells;
  const Eigen::Vector2d sigma_angle = problem.sigma_angle * cells;
  const Eigen::Matrix2d covariance = problem.covariance / (cells * cells);
  const Eigen::Matrix2d precision = covariance.inverse();
  const std::int64_t i0 = lowest_cell(position.x()), j0 = lowest_cell(position.y());
  const std::int64_t k0 = lowest_cell(angle.x()), l0 = lowest_cell(angle.y());

  const auto colors = static_cast<double>(densities->size());
  std::vector<double> sums(densities->size());
  for (std::int64_t i = i0; i < i0 + 2; ++i)
    for (std::int64_t j = j0; j < j0 + 2; ++j)
      for (std::int64_t k = k0; k < k0 + 2; ++k)
        for (std::int64_t l = l0; l < l0 + 2; ++l) {
          const Glint glint = glint_of_cell(i, j, k, l, level, problem.seed);
          const Eigen::Vector2d on_disk = Eigen::Vector2d(k, l) + glint.angle;
          if ((on_disk / cells - Eigen::Vector2d(0.5, 0.5)).norm() >= 0.5) continue;
          const Eigen::Vector2d d = Eigen::Vector2d(i, j) + glint.place - position;
          const Eigen::Vector2d n = (on_disk - angle).cwiseQuotient(sigma_angle);
          const double spatial =
              std::exp(-0.5 * d.dot(precision * d)) / (2 * kPi * std::sqrt(covariance.determinant()));
          const double angular =
              std::exp(-0.5 * n.squaredNorm()) / (2 * kPi * sigma_angle.x() * sigma_angle.y());
          const double r = glint.roulette;
          sums[static_cast<std::size_t>(glint.color * colors)] +=
              smoothstep(std::max(0.0, r - 0.1), std::min(1.0, r + 0.1), weight) * spatial *
              angular *  // Eq. 8
              presence(glint.presence, problem.share * problem.kept) / problem.kept;
        }

  const Eigen::Vector2d sigma = covariance.diagonal().cwiseSqrt();
  double inside = 1, square = 1, near = 1;
  const std::int64_t lowest[2] = {i0, j0}, lowest_angle[2] = {k0, l0};
  for (int axis = 0; axis < 2; ++axis) {
    const double low = static_cast<double>(lowest[axis]), low_angle = static_cast<double>(lowest_angle[axis]);
    inside *= share(low, low + 2, position[axis], sigma[axis]);
    square *= share(0, cells, angle[axis], sigma_angle[axis]);
    near *= share(std::max(low_angle, 0.0), std::min(low_angle + 2, cells), angle[axis], sigma_angle[axis]);
  }
  for (std::size_t color = 0; color < sums.size(); ++color)  // Eqs. 10, 11
    (*densities)[color] += sums[color] / inside + problem.share * weight * (square - near) / colors;
}

}  // namespace

Glint glint_of_cell(std::int64_t i, std::int64_t j, std::int64_t k, std::int64_t l, int level,
                    std::uint32_t seed) {
  const auto u32 = [](std::int64_t x) { return static_cast<std::uint32_t>(x); };
  const std::uint32_t row = mix((u32(j) & kCellMask) * 0x9e3779b1u + u32(level) * 0x85ebca77u + seed);
  const std::uint32_t spatial = mix(row + (u32(i) & kCellMask) * 0xc2b2ae3du);
  const std::uint32_t angular = mix(u32(l) * 0x27d4eb2fu + u32(k) * 0x165667b1u);
  const std::uint32_t a = mix(spatial + angular), b = mix(a + 0x9e3779b9u), c = (a + b) * 0x2545f495u;
  const std::uint32_t d = mix(b + 0x3c6ef372u);
  const auto unit = [](std::uint32_t bits) { return (bits + 0.5) / 65536; };
  return {{unit(a & 0xffffu), unit(a >> 16)},
          {unit(b & 0xffffu), unit(b >> 16)},
          unit(c >> 16),
          unit(d >> 16),
          unit(d & 0xffffu)};
}

GlintProcess::GlintProcess(const GlintPoint& point)
    : beckmann(point.distribution == Distribution::beckmann),
      alpha_x(point.alpha_x),
      alpha_y(point.alpha_y),
      density(point.density),
      stretch(point.stretch),
      seed(point.seed),
      share(point.share),
      kept(point.kept) {}

double GlintProcess::smooth_density(const Eigen::Vector2d& half_vector) const {
  const double cos2 = 1 - half_vector.squaredNorm();
  if (cos2 <= 0) return 0;
  const Eigen::Vector2d scaled(half_vector.x() / alpha_x, half_vector.y() / alpha_y);
  const double scale = 1 / (kPi * alpha_x * alpha_y);
  if (beckmann) return scale * std::exp(-scaled.squaredNorm() / cos2) / (cos2 * cos2);
  return scale / std::pow(scaled.squaredNorm() + cos2, 2);
}

Eigen::Vector2d GlintProcess::to_disk(const Eigen::Vector2d& half_vector) const {
  const double cos2 = std::max(1 - half_vector.squaredNorm(), 1e-300);
  const Eigen::Vector2d scaled(half_vector.x() / alpha_x, half_vector.y() / alpha_y);
  double radius = std::sqrt(scaled.squaredNorm() / (scaled.squaredNorm() + cos2));
  if (beckmann) radius = std::sqrt(-std::expm1(-scaled.squaredNorm() / cos2));
  return Eigen::Vector2d(0.5, 0.5) + 0.5 * radius * scaled.stableNormalized();
}

Eigen::Vector2d GlintProcess::from_disk(const Eigen::Vector2d& point) const {
  const Eigen::Vector2d v = 2 * (point - Eigen::Vector2d(0.5, 0.5));
  const double radius = std::min(v.norm(), 1 - 1e-15);
  const double slope =
      beckmann ? std::sqrt(-std::log1p(-radius * radius)) : radius / std::sqrt(1 - radius * radius);
  const Eigen::Vector2d slopes = slope * v.stableNormalized().cwiseProduct(Eigen::Vector2d(alpha_x, alpha_y));
  return slopes / std::sqrt(1 + slopes.squaredNorm());
}

std::vector<double> GlintProcess::densities_of(const Query& query, int colors) const {
  std::vector<double> densities(static_cast<std::size_t>(colors));
  const double smooth = smooth_density(query.half_vector);
  if (smooth == 0) return densities;
  const double resolution = std::sqrt(density), root = std::sqrt(stretch);
  const Eigen::DiagonalMatrix<double, 2> to_cells(resolution / root, resolution * root);
  Problem problem;
  problem.position = to_cells * query.footprint.mean_uv;
  problem.covariance = to_cells * query.footprint.cov_uv * to_cells;
  problem.angle = to_disk(query.half_vector);
  const double jacobian = std::sqrt(kPi / 4 * smooth);  // how lengths change, Eq. 3
  problem.sigma_angle = query.roughness * jacobian * Eigen::Vector2d(1 / root, root);
  problem.seed = seed, problem.share = share, problem.kept = kept;

  const double sigma = std::sqrt(std::max(principal_axes(problem.covariance).eigenvalues[1], 1e-100));
  const double detail = std::clamp(std::log2(8 * sigma), 0.0, 24.0);
  const int level = static_cast<int>(detail);
  problem.covariance += std::pow(std::exp2(level) / 128, 2) * Eigen::Matrix2d::Identity();
  const double weight = 1 - (detail - level);
  add_level(problem, level, weight, &densities);
  add_level(problem, level + 1, 1 - weight, &densities);
  for (double& value : densities) value *= smooth;
  return densities;
}

}  // namespace mica::host::reference
