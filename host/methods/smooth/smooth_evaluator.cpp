#include "host/methods/smooth/smooth_evaluator.h"

#include <tbb/parallel_for.h>

#include <Eigen/LU>
#include <cmath>

#include "host/base/constants.h"
#include "host/base/stopwatch.h"
#include "host/methods/map/first_order.h"
#include "host/methods/map/map_query.h"
#include "host/methods/map/turned_query.h"

namespace mica::host {

SmoothEvaluator::SmoothEvaluator(Device& device, const Surface& surface, const MixtureSettings& settings)
    : device_(device),
      wave_form_(settings.wave_form.value_or(device.wave_form())),
      batch_queries_(settings.batch_queries) {
  const Stopwatch watch;
  const LobeStructure lobes = build_lobes(surface, settings.elements);
  const SlopePyramid pyramid = build_slope_pyramid(lobes, true);
  build_seconds_ = watch.seconds();
  levels_ = pyramid.levels;
  grid_ = {lobes.grid, lobes.slope_unit, lobes.spread_unit, surface.interpolation(), settings.elements};
  batches_.emplace(device, lobes.grid,
                   std::vector<cl::Buffer>{device.upload(pyramid.numbers, "the pyramid of slopes")},
                   pyramid.bytes(), "smooth/smooth", "", wave_form_, batch_queries_);
}

std::unique_ptr<PendingDensities> SmoothEvaluator::start(const std::vector<Query>& queries) {
  return start_by_order(
      queries, [this](const std::vector<Query>& some) { return start_plain(some); },
      [this](const std::vector<Query>& some) { return start_turned(some); });
}

std::unique_ptr<PendingDensities> SmoothEvaluator::start_plain(const std::vector<Query>& queries) {
  std::vector<device_types::mica_smooth_query> smooth_queries(queries.size());
  tbb::parallel_for(std::size_t{0}, queries.size(),
                    [&](std::size_t n) { smooth_queries[n] = plain(queries[n], queries[n].footprint); });
  return batches_->start(std::move(smooth_queries));
}

std::unique_ptr<PendingDensities> SmoothEvaluator::start_turned(const std::vector<Query>& queries) {
  if (!turned_)
    turned_.emplace(device_, batches_->grid(), batches_->structure(), batches_->device_bytes(),
                    "smooth/smooth", "-DMICA_FIRST_ORDER=1", wave_form_, batch_queries_);
  std::vector<device_types::mica_turned_smooth_query> turned_queries(queries.size());
  tbb::parallel_for(std::size_t{0}, queries.size(),
                    [&](std::size_t n) { turned_queries[n] = turned(queries[n]); });
  return turned_->start(std::move(turned_queries));
}

device_types::mica_smooth_query SmoothEvaluator::plain(const Query& query, const Footprint& footprint) const {
  device_types::mica_smooth_query result{};
  const LobeWeights weights = lobe_weights(footprint, grid_);
  result.map.mean_i = weights.mean_i, result.map.mean_j = weights.mean_j;
  result.map.inverse_roughness = static_cast<float>(1 / query.roughness);
  result.slopes = to_slope_footprint(weights, grid_.grid, levels_, kSmallRipple);
  const HalfSlope half = to_half_slope(query.half_vector);
  result.slope_x = static_cast<float>(half.slope.x()), result.slope_y = static_cast<float>(half.slope.y());
  result.map.scale = static_cast<float>(half.to_density / (2 * kPi));
  return result;
}

device_types::mica_turned_smooth_query SmoothEvaluator::turned(const Query& query) const {
  device_types::mica_turned_smooth_query result{};
  result.smooth = plain(with_round_lobe(query), query.footprint);
  const auto narrow = [](double x) { return static_cast<float>(x); };
  const Eigen::Matrix2d lobe = lobe_covariance(query);
  result.lobe_xx = narrow(lobe(0, 0)), result.lobe_xy = narrow(lobe(0, 1)),
  result.lobe_yy = narrow(lobe(1, 1));
  const HalfSlope half = to_half_slope(query.half_vector);
  if (half.to_density == 0) return result;
  const device_types::mica_slope_footprint& slopes = result.smooth.slopes;
  const Eigen::Vector2d cells(slopes.width, slopes.height);
  // The half vector turns over all of the footprint, with slopes that repeat over no more than periods.
  const Eigen::Matrix2d repeated = without_needless_periods(query.footprint).cov_uv;
  // Of the slope p = -h / h_z: dp = -(I + p p') dh / h_z.
  const double inverse_z = std::sqrt(1 + half.slope.squaredNorm());
  const Eigen::Matrix2d by_half =
      -inverse_z * (Eigen::Matrix2d::Identity() + half.slope * half.slope.transpose());
  const Eigen::Matrix2d turn = by_half * query.half_vector_turn;  // of slopes, per unit of uv
  Eigen::Matrix2d factor;  // of the weights' covariance: y has sigma_y, x follows it
  factor << slopes.sigma_x, slopes.shear * slopes.sigma_y, 0, slopes.sigma_y;
  const Eigen::Matrix2d cross =
      (factor * factor.transpose()).inverse() * cells.asDiagonal() * repeated * turn.transpose();
  const Eigen::Matrix2d own = turn * query.footprint.cov_uv * turn.transpose();
  result.cross_xx = narrow(cross(0, 0)), result.cross_xy = narrow(cross(0, 1));
  result.cross_yx = narrow(cross(1, 0)), result.cross_yy = narrow(cross(1, 1));
  result.turn_xx = narrow(own(0, 0)), result.turn_xy = narrow(own(0, 1)), result.turn_yy = narrow(own(1, 1));
  return result;
}

double SmoothEvaluator::device_seconds() const {
  return batches_->device_seconds() + (turned_ ? turned_->device_seconds() : 0);
}

}  // namespace mica::host
