#include "host/methods/cavities/cavity_query.h"

#include <algorithm>
#include <cmath>

#include "host/methods/gaussians/mixture.h"
#include "host/methods/map/map_query.h"

namespace mica::host {
namespace {

constexpr double kLeastCosine = 1e-6;  // of views and lights; closer to the horizon they count as this far

/// The area that both sides of a cavity with facets `half` show to `direction`, for a cavity of area 1; twice
/// over. [Che19] Eqs. 2 and 4
double seen_area(const Eigen::Vector3d& direction, const Eigen::Vector3d& half) {
  const double height = std::max(direction.z(), kLeastCosine);
  const double tilt = std::abs(half.head<2>().dot(direction.head<2>())) / half.z();
  return std::max(2 * height, height + tilt);
}

constexpr double kCellsASigma = 12;   // of a lattice of samples
constexpr double kSampleReach = 3.1;  // as SAMPLE_REACH of kernels/cavities/cavity_samples.cl

std::int32_t step_of(double seeds) {
  return static_cast<std::int32_t>(std::max(std::floor(seeds), 1.0));
}

}  // namespace

SeedWeights seed_weights(const Footprint& footprint, const CavityGrid& cavities) {
  const double w = cavities.grid.width, h = cavities.grid.height, spacing = 1.0 / cavities.per_texel;
  const double kernel = kPositionKernelVariance * spacing * spacing;
  SeedWeights weights;
  weights.footprint = without_needless_periods(footprint);
  weights.footprint.cov_uv += Eigen::Vector2d(kernel / (w * w), kernel / (h * h)).asDiagonal();
  // Seeds of interpolated maps begin at the centre of texel (0, 0), those of constant texels inside them.
  const bool constant_texels = cavities.interpolation == Interpolation::nearest;
  const double first = constant_texels ? 0.5 * spacing : 0.5;
  const Eigen::Vector2d size(w, h);
  const Eigen::Vector2d mean_uv = footprint.mean_uv.array() - footprint.mean_uv.array().floor();
  weights.mean_seeds = (mean_uv.cwiseProduct(size) - Eigen::Vector2d(first, first)) / spacing;
  const Eigen::Matrix2d to_seeds = (size / spacing).asDiagonal();
  weights.cov_seeds = to_seeds * weights.footprint.cov_uv * to_seeds;
  weights.sum = sum_of_weights(weights.cov_seeds, weights.mean_seeds + Eigen::Vector2d(0.5, 0.5));
  return weights;
}

double facet_reflection(const Eigen::Vector3d& view, const Eigen::Vector3d& light) {
  if (!(view.z() > 0 && light.z() > 0)) return 0;
  const Eigen::Vector3d half = (view + light).normalized();
  return 0.5 * light.z() / (seen_area(view, half) * seen_area(light, half));
}

device_types::mica_map_query to_cavity_query(const BrdfQuery& query, const CavityGrid& cavities,
                                             double cutoff) {
  const SeedWeights weights = seed_weights(query.footprint, cavities);
  Eigen::Vector3d half = query.view + query.light;
  const double reflection = facet_reflection(query.view, query.light);
  half = reflection > 0 ? Eigen::Vector3d(half.normalized()) : Eigen::Vector3d(Eigen::Vector3d::UnitZ());
  device_types::mica_map_query result = to_map_query({weights.footprint, half.head<2>(), query.roughness},
                                                     cavities.grid, cavities.interpolation, cutoff);
  const double spacing = 1.0 / cavities.per_texel;
  result.scale = static_cast<float>(result.scale * spacing * spacing / weights.sum * reflection);
  if (reflection == 0) result.cutoff = -1;  // nothing is looked at
  return result;
}

device_types::mica_cavity_query to_cavity_query(const ViewQuery& query, const CavityGrid& cavities,
                                                double cutoff) {
  device_types::mica_cavity_query result{};
  result.map = to_map_query(
      {seed_weights(query.footprint, cavities).footprint, Eigen::Vector2d::Zero(), query.roughness},
      cavities.grid, cavities.interpolation, cutoff);
  result.view_x = static_cast<float>(query.view.x());
  result.view_y = static_cast<float>(query.view.y());
  result.view_z = static_cast<float>(std::max(query.view.z(), kLeastCosine));
  result.roughness = static_cast<float>(query.roughness);
  result.lobe_sigma = static_cast<float>(specular_lobe_sigma(query.roughness, cavities.compensation_width));
  if (!(query.view.z() > 0)) result.map.cutoff = -1;  // nothing is looked at
  return result;
}

device_types::mica_sampled_cavity_query to_sampled_query(const ViewQuery& query, const CavityGrid& cavities,
                                                         double cutoff) {
  device_types::mica_sampled_cavity_query result{};
  result.cavity = to_cavity_query(query, cavities, cutoff);
  const SeedWeights weights = seed_weights(query.footprint, cavities);
  const int period_x = cavities.grid.width * cavities.per_texel,
            period_y = cavities.grid.height * cavities.per_texel;
  wrap_texel(weights.mean_seeds.x() / period_x, period_x, 0, &result.mean_i, &result.mean_x);
  wrap_texel(weights.mean_seeds.y() / period_y, period_y, 0, &result.mean_j, &result.mean_y);
  const Eigen::Matrix2d& cov = weights.cov_seeds;
  const double sigma_y = std::sqrt(cov(1, 1)), shear = cov(0, 1) / cov(1, 1),
               sigma_x = std::sqrt(cov(0, 0) - shear * cov(0, 1));
  result.sigma_x = static_cast<float>(sigma_x), result.sigma_y = static_cast<float>(sigma_y);
  result.shear = static_cast<float>(shear);
  // As many cells in a footprint that is thin one way: more of them the other way.
  const double cells = kCellsASigma * kCellsASigma;
  result.step_x = step_of(sigma_x * std::min(sigma_y, kCellsASigma) / cells);
  result.step_y = step_of(sigma_y * (sigma_x / result.step_x) / cells);
  const double groups = (2 * kSampleReach * sigma_x / result.step_x + 1) *
                        (2 * kSampleReach * sigma_y / result.step_y + 1) / 16;
  result.blur_step = 1;
  while (result.blur_step < 16 && 2 * result.blur_step <= groups) result.blur_step *= 2;
  return result;
}

}  // namespace mica::host
