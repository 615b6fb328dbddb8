#include "host/methods/beckmanns/lobe_query.h"

#include <algorithm>
#include <cmath>

#include "host/base/constants.h"
#include "host/methods/gaussians/mixture.h"
#include "host/methods/map/map_query.h"

namespace mica::host {
namespace {

constexpr double kLeastCosine = 1e-4;  // of a half vector; closer to the horizon there are no normals

}  // namespace

LobeWeights lobe_weights(const Footprint& footprint, const LobeGrid& lobes) {
  LobeWeights weights;
  // Elements of interpolated maps lie between texel centres, those of constant texels inside them.
  const double shift = lobes.interpolation == Interpolation::nearest ? 0.0 : 0.5 * lobes.elements;
  wrap_texel(footprint.mean_uv.x(), lobes.grid.width, shift, &weights.mean_i, &weights.mean_x);
  wrap_texel(footprint.mean_uv.y(), lobes.grid.height, shift, &weights.mean_j, &weights.mean_y);
  const FootprintAxes axes =
      footprint_axes(without_needless_periods(footprint), lobes.grid.width, lobes.grid.height);
  const auto narrowed = [](double sigma) {
    return std::sqrt(std::max(sigma * sigma - kPositionKernelVariance, kPositionKernelVariance));
  };
  weights.axes << axes.major, axes.minor;
  weights.sigma = {narrowed(axes.sigma_major_texels), narrowed(axes.sigma_minor_texels)};
  weights.sum = sum_of_weights(weights.covariance(), {weights.mean_x, weights.mean_y});
  return weights;
}

HalfSlope to_half_slope(const Eigen::Vector2d& half_vector) {
  const double squared_cosine = 1 - half_vector.squaredNorm();
  if (!(squared_cosine > kLeastCosine * kLeastCosine)) return {};
  return {-half_vector / std::sqrt(squared_cosine), 1 / (squared_cosine * squared_cosine)};
}

device_types::mica_lobe_query to_lobe_query(const Query& query, const LobeWeights& weights,
                                            const LobeGrid& lobes, double cutoff) {
  device_types::mica_lobe_query result{};
  device_types::mica_map_query& map = result.map;
  map.mean_i = weights.mean_i, map.mean_j = weights.mean_j;
  map.mean_x = weights.mean_x, map.mean_y = weights.mean_y;
  const Eigen::Vector2d row_1 = weights.axes.col(0) / weights.sigma[0],
                        row_2 = weights.axes.col(1) / weights.sigma[1];
  map.whiten_1x = static_cast<float>(row_1.x()), map.whiten_1y = static_cast<float>(row_1.y());
  map.whiten_2x = static_cast<float>(row_2.x()), map.whiten_2y = static_cast<float>(row_2.y());
  const Eigen::Matrix2d covariance = weights.covariance();
  map.extent_x = static_cast<float>(std::sqrt(cutoff * covariance(0, 0)));
  map.extent_y = static_cast<float>(std::sqrt(cutoff * covariance(1, 1)));
  map.inverse_roughness = static_cast<float>(1 / query.roughness);
  map.cutoff = static_cast<float>(cutoff);

  const HalfSlope half = to_half_slope(query.half_vector);
  const Eigen::Vector2d& slope = half.slope;
  result.slope_x = static_cast<float>(slope.x()), result.slope_y = static_cast<float>(slope.y());
  result.slope_rest_x = static_cast<float>(slope.x() - result.slope_x);
  result.slope_rest_y = static_cast<float>(slope.y() - result.slope_y);
  result.slope_unit = lobes.slope_unit;
  const double spread_unit = lobes.spread_unit / query.roughness;
  result.spread_variance = static_cast<float>(spread_unit * spread_unit);
  map.scale = static_cast<float>(half.to_density / (4 * kPi * kPi * weights.sigma[0] * weights.sigma[1] *
                                                    weights.sum * query.roughness * query.roughness));
  return result;
}

}  // namespace mica::host
