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

/// What two normal variables with a covariance have in a rectangle relative to their means: the share of the
/// second one, by its mean given the first, is integrated over the first.
double rectangle_share(const Eigen::Vector2d& low, const Eigen::Vector2d& high,
                       const Eigen::Matrix2d& covariance) {
  const double sigma = std::sqrt(covariance(0, 0)), slope = covariance(0, 1) / covariance(0, 0);
  const double left = std::sqrt(covariance.determinant() / covariance(0, 0));
  if (slope == 0) return share(low.x(), high.x(), 0, sigma) * share(low.y(), high.y(), 0, left);
  const double from = std::max(low.x(), -9 * sigma), to = std::min(high.x(), 9 * sigma);
  if (!(from < to)) return 0;
  constexpr double steps_a_scale = 24;
  const double scale = std::min(sigma, left / std::abs(slope));
  const int steps = 2 * static_cast<int>(std::ceil(std::min(0.5 * steps_a_scale * (to - from) / scale, 1e5)));
  double sum = 0;
  for (int n = 0; n <= steps; ++n) {  // Simpson
    const double x = from + (to - from) * n / steps;
    const double weight = n == 0 || n == steps ? 1 : n % 2 == 1 ? 4 : 2;
    sum += weight * std::exp(-0.5 * x * x / covariance(0, 0)) * share(low.y(), high.y(), slope * x, left);
  }
  return sum * (to - from) / (3 * steps) / (std::sqrt(2 * kPi) * sigma);
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
  Eigen::Matrix2d lobe;        ///< its covariance, there
  Eigen::Matrix2d turn;        ///< of the angle, per cell of level 0
  std::uint32_t seed;
  double share, kept;
  int angular_cells;
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
  const Eigen::Matrix2d lobe = problem.lobe * cells * cells, turn = problem.turn * cells * cells;
  const Eigen::Matrix2d covariance = problem.covariance / (cells * cells);
  const Eigen::Matrix2d precision = covariance.inverse(), lobe_precision = lobe.inverse();
  const std::int64_t i0 = lowest_cell(position.x()), j0 = lowest_cell(position.y());
  const std::int64_t beside = problem.angular_cells / 2 - 1;
  const std::int64_t k0 = lowest_cell(angle.x()) - beside, l0 = lowest_cell(angle.y()) - beside;

  const auto colors = static_cast<double>(densities->size());
  std::vector<double> sums(densities->size());
  for (std::int64_t i = i0; i < i0 + 2; ++i)
    for (std::int64_t j = j0; j < j0 + 2; ++j)
      for (std::int64_t k = k0; k < k0 + problem.angular_cells; ++k)
        for (std::int64_t l = l0; l < l0 + problem.angular_cells; ++l) {
          const Glint glint = glint_of_cell(i, j, k, l, level, problem.seed);
          const Eigen::Vector2d on_disk = Eigen::Vector2d(k, l) + glint.angle;
          if ((on_disk / cells - Eigen::Vector2d(0.5, 0.5)).norm() >= 0.5) continue;
          const Eigen::Vector2d d = Eigen::Vector2d(i, j) + glint.place - position;
          const Eigen::Vector2d n = on_disk - angle - turn * d;
          const double spatial =
              std::exp(-0.5 * d.dot(precision * d)) / (2 * kPi * std::sqrt(covariance.determinant()));
          const double angular =
              std::exp(-0.5 * n.dot(lobe_precision * n)) / (2 * kPi * std::sqrt(lobe.determinant()));
          const double r = glint.roulette;
          sums[static_cast<std::size_t>(glint.color * colors)] +=
              smoothstep(std::max(0.0, r - 0.1), std::min(1.0, r + 0.1), weight) * spatial *
              angular *  // Eq. 8
              presence(glint.presence, problem.share * problem.kept) / problem.kept;
        }

  const Eigen::Vector2d sigma = covariance.diagonal().cwiseSqrt();
  const Eigen::Matrix2d spread = lobe + turn * covariance * turn.transpose();
  const Eigen::Vector2d lowest(i0, j0), lowest_angle(k0, l0);
  double inside = 1, square = 1;
  for (int axis = 0; axis < 2; ++axis) {
    inside *= share(lowest[axis], lowest[axis] + 2, position[axis], sigma[axis]);
    square *= share(0, cells, angle[axis], std::sqrt(spread(axis, axis)));
  }
  const Eigen::Vector2d low = lowest_angle.cwiseMax(0) - angle,
                        high = (lowest_angle.array() + problem.angular_cells).min(cells).matrix() - angle;
  const double beyond = std::max(square - rectangle_share(low, high, spread), 0.0);
  for (std::size_t color = 0; color < sums.size(); ++color)  // Eqs. 10, 11
    (*densities)[color] += sums[color] / inside + problem.share * weight * beyond / colors;
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

/// By differences: of half vectors on the disk.
Eigen::Matrix2d GlintProcess::map_jacobian(const Eigen::Vector2d& half_vector) const {
  const double step = 1e-5 * (1 - half_vector.squaredNorm());
  Eigen::Matrix2d jacobian;
  for (int axis = 0; axis < 2; ++axis) {
    const Eigen::Vector2d d = step * Eigen::Vector2d::Unit(axis);
    jacobian.col(axis) = (to_disk(half_vector + d) - to_disk(half_vector - d)) / (2 * step);
  }
  return jacobian;
}

double GlintProcess::mean_density(const Query& query) const {
  const Eigen::Matrix2d& turn = query.half_vector_turn;
  if (turn.isZero(0)) return smooth_density(query.half_vector);
  const PrincipalAxes axes = principal_axes(turn * query.footprint.cov_uv * turn.transpose());
  const Eigen::Vector2d sigma = axes.eigenvalues.cwiseMax(0).cwiseSqrt();
  const Eigen::Matrix2d root = axes.eigenvectors * sigma.asDiagonal() * axes.eigenvectors.transpose();
  constexpr double nodes[] = {-1.7320508075688772, 0, 1.7320508075688772},
                   weights[] = {1.0 / 6, 2.0 / 3, 1.0 / 6};  // Gauss-Hermite
  double sum = 0;
  for (int n = 0; n < 9; ++n) {
    const Eigen::Vector2d offset = root * Eigen::Vector2d(nodes[n / 3], nodes[n % 3]);
    sum += weights[n / 3] * weights[n % 3] * smooth_density(query.half_vector + offset);
  }
  return sum;
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
  const double jacobian = std::sqrt(std::max(kPi / 4 * smooth, 1e-100));  // how lengths change, Eq. 3
  const Eigen::DiagonalMatrix<double, 2> to_square(jacobian / root, jacobian * root);
  problem.lobe = to_square * lobe_covariance(query) * to_square;
  problem.turn.setZero();
  problem.seed = seed, problem.share = share, problem.kept = kept;
  problem.angular_cells = angular_cells;

  const PrincipalAxes axes = principal_axes(problem.covariance);
  const double detail =
      std::clamp(std::log2(8 * std::sqrt(std::max(axes.eigenvalues[1], 1e-100))), 0.0, 24.0);
  const int level = static_cast<int>(detail);
  const double wider = std::pow(std::exp2(level) / 128, 2);
  problem.covariance += wider * Eigen::Matrix2d::Identity();
  if (!query.half_vector_turn.isZero(0)) {
    // What a footprint is widened by sees no further turn.
    const Eigen::Vector2d true_variances = axes.eigenvalues.cwiseMax(0);
    const Eigen::Vector2d narrower = (true_variances.array() / (true_variances.array() + wider)).sqrt();
    problem.turn = map_jacobian(query.half_vector) * query.half_vector_turn * to_cells.inverse() *
                   axes.eigenvectors * narrower.asDiagonal() * axes.eigenvectors.transpose();
  }
  const double weight = 1 - (detail - level);
  add_level(problem, level, weight, &densities);
  add_level(problem, level + 1, 1 - weight, &densities);
  const double mean = mean_density(query);
  for (double& value : densities) value *= mean;
  return densities;
}

}  // namespace mica::host::reference
