#include "host/engine/map_query.h"

#include <fmt/format.h>

#include <cmath>

namespace mica {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kMinRoughness = 1e-5, kMaxRoughness = 1;
constexpr double kMinSigmaTexels = 1e-3, kMaxSigmaTexels = 1e6;

/// a * b - c * d without cancellation. Kahan's algorithm with fused multiply-add.
double difference_of_products(double a, double b, double c, double d) {
  const double cd = c * d;
  return std::fma(a, b, -cd) + std::fma(-c, d, cd);
}

/// Whole texels in [0, size) and the rest in [0, 1) of a texture coordinate less `shift` texels.
void wrap_texel(double coordinate, int size, double shift, std::int32_t* whole, float* rest) {
  const double texels = (coordinate - std::floor(coordinate)) * size - shift;
  const double base = std::floor(texels);
  *whole = static_cast<std::int32_t>(base);
  *rest = static_cast<float>(texels - base);
  if (*rest >= 1.0f) *rest = 0.0f, ++*whole;  // rounded up
  *whole = (*whole % size + size) % size;
}

/// On a periodic map a footprint far wider than a period is a uniform one, and so is one of 0.8 periods: of
/// the wrapped Gaussian's Fourier series exp(-2 pi^2 sigma^2 |k|^2) only 4 * 3e-6 is left beside the mean.
Footprint without_needless_periods(const Footprint& footprint) {
  constexpr double uniform_variance = 0.8 * 0.8;
  const Eigen::Matrix2d& cov = footprint.cov_uv;
  const double smallest =
      0.5 * (cov(0, 0) + cov(1, 1)) - std::hypot(0.5 * (cov(0, 0) - cov(1, 1)), cov(0, 1));
  if (smallest <= uniform_variance) return footprint;
  return {footprint.mean_uv, Eigen::Matrix2d::Identity() * uniform_variance};
}

std::int32_t to_fixed(double normal) {
  return static_cast<std::int32_t>(std::lround(normal * MICA_NORMAL_ONE));
}

}  // namespace

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
  if (!(query.roughness >= kMinRoughness && query.roughness <= kMaxRoughness))
    return fmt::format("roughness {} is outside [{}, {}]", query.roughness, kMinRoughness, kMaxRoughness);
  const Eigen::Matrix2d& cov = query.footprint.cov_uv;
  if (!(cov(0, 0) > 0 && cov(1, 1) > 0 &&
        difference_of_products(cov(0, 0), cov(1, 1), cov(0, 1), cov(0, 1)) > 0))
    return "covariance is not positive definite";
  const FootprintAxes axes = footprint_axes(query.footprint, map_width, map_height);
  if (!(axes.sigma_minor_texels >= kMinSigmaTexels && axes.sigma_major_texels <= kMaxSigmaTexels))
    return fmt::format("footprint of {:.3g} x {:.3g} texels (standard deviations) is outside [{}, {:g}]",
                       axes.sigma_major_texels, axes.sigma_minor_texels, kMinSigmaTexels, kMaxSigmaTexels);
  return {};
}

device_types::mica_map_query to_map_query(const Query& query, const device_types::mica_map_grid& grid,
                                          Interpolation interpolation, double cutoff) {
  device_types::mica_map_query result{};
  // Interpolated quads span texel centres, constant texels span texels.
  const double shift = interpolation == Interpolation::nearest ? 0.0 : 0.5;
  wrap_texel(query.footprint.mean_uv.x(), grid.width, shift, &result.mean_i, &result.mean_x);
  wrap_texel(query.footprint.mean_uv.y(), grid.height, shift, &result.mean_j, &result.mean_y);

  const Footprint footprint = without_needless_periods(query.footprint);
  const FootprintAxes axes = footprint_axes(footprint, grid.width, grid.height);
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

double cutoff_for(double relative_error) {
  return -2 * std::log(relative_error);
}

}  // namespace mica
