#include "host/methods/map/map_query.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <cmath>
#include <utility>

#include "host/base/constants.h"
#include "host/methods/gaussians/mixture.h"
#include "host/methods/map/periods.h"
#include "host/methods/map/turned_query.h"

namespace mica::host {
namespace {

constexpr double kMinSigmaTexels = 1e-3, kMaxSigmaTexels = 1e6;

/// a * b - c * d without cancellation. Kahan's algorithm with fused multiply-add.
double difference_of_products(double a, double b, double c, double d) {
  const double cd = c * d;
  return std::fma(a, b, -cd) + std::fma(-c, d, cd);
}

std::int32_t to_fixed(double normal) {
  return static_cast<std::int32_t>(std::lround(normal * MICA_NORMAL_ONE));
}

}  // namespace

Eigen::Matrix2d reduced_waves(const Eigen::Matrix2d& form) {
  Eigen::Vector2d a(1, 0), b(0, 1);
  for (;;) {
    if (a.dot(form * a) > b.dot(form * b)) std::swap(a, b);
    const double multiple = std::round(a.dot(form * b) / a.dot(form * a));
    if (multiple == 0) break;
    const Eigen::Vector2d shorter = b - multiple * a;
    if (!(shorter.dot(form * shorter) < b.dot(form * b))) break;
    b = shorter;
  }
  Eigen::Matrix2d waves;
  waves << a, b;
  return waves;
}

void wrap_texel(double coordinate, int size, double shift, std::int32_t* whole, float* rest) {
  const double texels = (coordinate - std::floor(coordinate)) * size - shift;
  const double base = std::floor(texels);
  *whole = static_cast<std::int32_t>(base);
  *rest = static_cast<float>(texels - base);
  if (*rest >= 1.0f) *rest = 0.0f, ++*whole;  // rounded up
  *whole = (*whole % size + size) % size;
}

/// On a periodic map a footprint weights each wave k of the map's Fourier series, k a pair of integers, by
/// exp(-2 pi^2 k' cov k). Where that exponent lets nothing through, covariances that let nothing through
/// either are as good: a footprint of many periods has one of at most 0.8, of which 4 * 3e-6 is left beside
/// the mean. One that is long only one way, and still sees waves across it, becomes as short as keeps just
/// those: 0.8 periods of the lattice line along it.
Footprint without_needless_periods(const Footprint& footprint) {
  constexpr double uniform_variance = kUniformVariance;
  if (footprint.cov_uv.diagonal().maxCoeff() <= uniform_variance) return footprint;  // as most are
  const Eigen::Matrix2d waves = reduced_waves(footprint.cov_uv);
  const Eigen::Matrix2d form = waves.transpose() * footprint.cov_uv * waves;
  if (form(1, 1) <= uniform_variance) return footprint;
  if (form(0, 0) > uniform_variance)
    return {footprint.mean_uv, Eigen::Matrix2d::Identity() * uniform_variance};
  const Eigen::Matrix2d to_plane =
      waves.inverse().array().round().matrix();  // of integers: its determinant is 1
  const Eigen::Vector2d variances(form(0, 0), uniform_variance);
  return {footprint.mean_uv, to_plane.transpose() * variances.asDiagonal() * to_plane};
}

FootprintAxes footprint_axes(const Footprint& footprint, int map_width, int map_height) {
  const double w = map_width, h = map_height;
  const double a = footprint.cov_uv(0, 0) * w * w, b = footprint.cov_uv(0, 1) * w * h,
               c = footprint.cov_uv(1, 1) * h * h;
  const double half_difference = 0.5 * (a - c);
  const double root = std::hypot(half_difference, b);
  const double large = 0.5 * (a + c) + root;
  const double small = difference_of_products(a, c, b, b) / large;  // keeps the small one's digits
  FootprintAxes axes;
  if (root == 0) {
    axes.major = {1, 0};
  } else if (half_difference >= 0) {
    axes.major = Eigen::Vector2d(half_difference + root, b).normalized();
  } else {
    axes.major = Eigen::Vector2d(b, root - half_difference).normalized();
  }
  axes.minor = {-axes.major.y(), axes.major.x()};
  axes.sigma_major_texels = std::sqrt(large);
  axes.sigma_minor_texels = small > 0 ? std::sqrt(small) : 0;
  return axes;
}

std::string query_problem(const Query& query, int map_width, int map_height) {
  if (!query.footprint.mean_uv.allFinite()) return "uv is not finite";
  if (!query.footprint.cov_uv.allFinite()) return "covariance is not finite";
  if (!query.half_vector.allFinite()) return "half vector is not finite";
  if (query.half_vector.cwiseAbs().maxCoeff() > 1)
    return fmt::format("half vector ({}, {}) is outside [-1, 1]^2", query.half_vector.x(),
                       query.half_vector.y());
  if (!query.lobe_cov && !(query.roughness >= kMinRoughness && query.roughness <= kMaxRoughness))
    return fmt::format("roughness {} is outside [{}, {}]", query.roughness, kMinRoughness, kMaxRoughness);
  const Eigen::Matrix2d& cov = query.footprint.cov_uv;
  if (!(cov(0, 0) > 0 && cov(1, 1) > 0 &&
        difference_of_products(cov(0, 0), cov(1, 1), cov(0, 1), cov(0, 1)) > 0))
    return "covariance is not positive definite";
  const FootprintAxes axes = footprint_axes(query.footprint, map_width, map_height);
  if (!(axes.sigma_minor_texels >= kMinSigmaTexels && axes.sigma_major_texels <= kMaxSigmaTexels))
    return fmt::format("footprint of {:.3g} x {:.3g} texels (standard deviations) is outside [{}, {:g}]",
                       axes.sigma_major_texels, axes.sigma_minor_texels, kMinSigmaTexels, kMaxSigmaTexels);
  return query.lobe_cov || has_first_order(query) ? first_order_problem(query, map_width, map_height) : "";
}

device_types::mica_map_query to_map_query(const Query& query, const device_types::mica_map_grid& grid,
                                          Interpolation interpolation, double cutoff) {
  const Footprint footprint = without_needless_periods(query.footprint);
  const FootprintAxes axes = footprint_axes(footprint, grid.width, grid.height);
  return to_map_query(query, footprint, axes, grid, interpolation, cutoff);
}

device_types::mica_map_query to_map_query(const Query& query, const Footprint& footprint,
                                          const FootprintAxes& axes, const device_types::mica_map_grid& grid,
                                          Interpolation interpolation, double cutoff) {
  device_types::mica_map_query result{};
  // Interpolated quads span texel centres, constant texels span texels.
  const double shift = interpolation == Interpolation::nearest ? 0.0 : 0.5;
  wrap_texel(query.footprint.mean_uv.x(), grid.width, shift, &result.mean_i, &result.mean_x);
  wrap_texel(query.footprint.mean_uv.y(), grid.height, shift, &result.mean_j, &result.mean_y);

  const Eigen::Vector2d row_1 = axes.major / axes.sigma_major_texels,
                        row_2 = axes.minor / axes.sigma_minor_texels;
  result.whiten_1x = static_cast<float>(row_1.x()), result.whiten_1y = static_cast<float>(row_1.y());
  result.whiten_2x = static_cast<float>(row_2.x()), result.whiten_2y = static_cast<float>(row_2.y());
  const double reach = std::sqrt(cutoff);
  result.extent_x = static_cast<float>(reach * std::sqrt(footprint.cov_uv(0, 0)) * grid.width);
  result.extent_y = static_cast<float>(reach * std::sqrt(footprint.cov_uv(1, 1)) * grid.height);

  result.half_s = to_fixed(query.half_vector.x());
  result.half_t = to_fixed(query.half_vector.y());
  result.inverse_roughness = static_cast<float>(1 / query.roughness);
  result.cutoff = static_cast<float>(cutoff);
  result.scale = static_cast<float>(1 / (4 * kPi * kPi * axes.sigma_major_texels * axes.sigma_minor_texels *
                                         query.roughness * query.roughness));
  return result;
}

device_types::mica_map_query to_triangle_query(const Query& query, const device_types::mica_map_grid& grid,
                                               Interpolation interpolation, double cutoff) {
  device_types::mica_map_query result = to_map_query(query, grid, interpolation, cutoff);
  const Eigen::Matrix2d& cov = query.footprint.cov_uv;
  const Eigen::Vector2d shortest = reduced_waves(cov).col(0);
  if (shortest.dot(cov * shortest) <= kUniformVariance) return result;
  // From the first texel to the last, under a Gaussian so wide that it is a constant.
  constexpr double sigma_periods = 300;  // at the corners the weight is 3e-6 less
  const double width = grid.width, height = grid.height;
  result.mean_i = result.mean_j = 0;
  result.mean_x = static_cast<float>(width / 2), result.mean_y = static_cast<float>(height / 2);
  result.extent_x = result.mean_x - 0.25f, result.extent_y = result.mean_y - 0.25f;
  result.whiten_1x = static_cast<float>(1 / (sigma_periods * width));
  result.whiten_2y = static_cast<float>(1 / (sigma_periods * height));
  result.whiten_1y = result.whiten_2x = 0;
  result.scale = static_cast<float>(1 / (2 * kPi * width * height * query.roughness * query.roughness));
  return result;
}

double sum_of_weights(const Eigen::Matrix2d& cov_spacings, const Eigen::Vector2d& mean_spacings) {
  constexpr int orders = 2;       // the third one's terms are below exp(-2 pi^2 9 k) = 1e-14
  constexpr double nothing = 20;  // exp(-20) = 2e-9 of the sum
  const double a = cov_spacings(0, 0), b = cov_spacings(0, 1), c = cov_spacings(1, 1);
  const double least_variance = 0.5 * (a + c) - std::hypot(0.5 * (a - c), b);
  if (2 * kPi * kPi * least_variance > nothing) return 1;  // of every wave: |(x, y)| >= 1
  const double phase_x = 2 * kPi * (0.5 - mean_spacings.x()), phase_y = 2 * kPi * (0.5 - mean_spacings.y());
  // Waves come in pairs of equal terms, (x, y) and (-x, -y).
  double half_sum = 0;
  for (int x = 0; x <= orders; ++x) {
    for (int y = x == 0 ? 1 : -orders; y <= orders; ++y) {
      const double exponent = 2 * kPi * kPi * (a * x * x + 2 * b * x * y + c * y * y);
      if (exponent < nothing) half_sum += std::exp(-exponent) * std::cos(x * phase_x + y * phase_y);
    }
  }
  return 1 + 2 * half_sum;
}

device_types::mica_mixture_query to_mixture_query(const Query& query, const device_types::mica_map_grid& grid,
                                                  Interpolation interpolation, int elements, double cutoff) {
  return to_mixture_query(query, without_needless_periods(query.footprint), grid, interpolation, elements,
                          cutoff);
}

device_types::mica_mixture_query to_mixture_query(const Query& query, const Footprint& footprint,
                                                  const device_types::mica_map_grid& grid,
                                                  Interpolation interpolation, int elements, double cutoff) {
  device_types::mica_mixture_query result{};
  const FootprintAxes axes = footprint_axes(footprint, grid.width, grid.height);
  result.map = to_map_query(query, footprint, axes, grid, interpolation, cutoff);
  const double spacing = 1.0 / elements;
  const double k = kPositionKernelVariance * spacing * spacing;
  const double sigma_1 = axes.sigma_major_texels, sigma_2 = axes.sigma_minor_texels;
  const double tau_1 = std::sqrt(sigma_1 * sigma_1 + k), tau_2 = std::sqrt(sigma_2 * sigma_2 + k);
  const Eigen::Vector2d row_1 = axes.major / tau_1, row_2 = axes.minor / tau_2;
  result.axis_1x = static_cast<float>(row_1.x()), result.axis_1y = static_cast<float>(row_1.y());
  result.axis_2x = static_cast<float>(row_2.x()), result.axis_2y = static_cast<float>(row_2.y());
  result.blur_1 = static_cast<float>(std::sqrt(k) * sigma_1 / query.roughness);
  result.blur_2 = static_cast<float>(std::sqrt(k) * sigma_2 / query.roughness);
  result.kernel_variance = static_cast<float>(k);

  // An element's exponent is the least, over u, of |u - m|^2 / F + |u - c|^2 / k + |s - s0 - J (u - c)|^2 /
  // sigma_r^2. With a share of the middle term for each of the others, it is at least a bound on the position
  // plus one on the normal.
  const double share = std::sqrt(k) / (std::sqrt(k) + sigma_2);  // of the position
  const double widening = k / share;
  const Eigen::Matrix2d wide = sigma_1 * sigma_1 * axes.major * axes.major.transpose() +
                               sigma_2 * sigma_2 * axes.minor * axes.minor.transpose() +
                               widening * Eigen::Matrix2d::Identity();
  const Eigen::Vector2d wide_1 = axes.major / std::sqrt(sigma_1 * sigma_1 + widening),
                        wide_2 = axes.minor / std::sqrt(sigma_2 * sigma_2 + widening);
  result.map.whiten_1x = static_cast<float>(wide_1.x()),
  result.map.whiten_1y = static_cast<float>(wide_1.y());
  result.map.whiten_2x = static_cast<float>(wide_2.x()),
  result.map.whiten_2y = static_cast<float>(wide_2.y());
  result.map.extent_x = static_cast<float>(std::sqrt(cutoff * wide(0, 0)));
  result.map.extent_y = static_cast<float>(std::sqrt(cutoff * wide(1, 1)));
  const double spread_unit = device_types::MICA_SPREAD_UNIT / (MICA_BOUND_ONE * query.roughness);
  result.spread_variance = static_cast<float>(spread_unit * spread_unit / (1 - share));

  const Eigen::Matrix2d cov_spacings = (tau_1 * tau_1 * axes.major * axes.major.transpose() +
                                        tau_2 * tau_2 * axes.minor * axes.minor.transpose()) /
                                       (spacing * spacing);
  const Eigen::Vector2d mean_spacings = Eigen::Vector2d(result.map.mean_x, result.map.mean_y) / spacing;
  result.map.scale = static_cast<float>(spacing * spacing / sum_of_weights(cov_spacings, mean_spacings) /
                                        (4 * kPi * kPi * tau_1 * tau_2 * query.roughness * query.roughness));
  return result;
}

double cutoff_for(double relative_error) {
  return -2 * std::log(relative_error);
}

}  // namespace mica::host
