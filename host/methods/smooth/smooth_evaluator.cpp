#include "host/methods/smooth/smooth_evaluator.h"

#include <tbb/parallel_for.h>

#include <cmath>

#include "host/base/constants.h"
#include "host/base/stopwatch.h"

namespace mica::host {
namespace {}  // namespace

SmoothEvaluator::SmoothEvaluator(Device& device, const Surface& surface, const MixtureSettings& settings) {
  const Stopwatch watch;
  const LobeStructure lobes = build_lobes(surface, settings.elements);
  const SlopePyramid pyramid = build_slope_pyramid(lobes, true);
  build_seconds_ = watch.seconds();
  levels_ = pyramid.levels;
  grid_ = {lobes.grid, lobes.slope_unit, lobes.spread_unit, surface.interpolation(), settings.elements};
  batches_.emplace(device, lobes.grid,
                   std::vector<cl::Buffer>{device.upload(pyramid.numbers, "the pyramid of slopes")},
                   pyramid.bytes(), "smooth/smooth", "", settings.wave_form.value_or(device.wave_form()),
                   settings.batch_queries);
}

std::unique_ptr<PendingDensities> SmoothEvaluator::start(const std::vector<Query>& queries) {
  std::vector<device_types::mica_smooth_query> smooth_queries(queries.size());
  tbb::parallel_for(std::size_t{0}, queries.size(), [&](std::size_t n) {
    device_types::mica_smooth_query& result = smooth_queries[n];
    const LobeWeights weights = lobe_weights(queries[n].footprint, grid_);
    result.map.mean_i = weights.mean_i, result.map.mean_j = weights.mean_j;
    result.map.inverse_roughness = static_cast<float>(1 / queries[n].roughness);
    result.slopes = to_slope_footprint(weights, grid_.grid, levels_, kSmallRipple);
    const HalfSlope half = to_half_slope(queries[n].half_vector);
    result.slope_x = static_cast<float>(half.slope.x()), result.slope_y = static_cast<float>(half.slope.y());
    result.map.scale = static_cast<float>(half.to_density / (2 * kPi));
  });
  return batches_->start(std::move(smooth_queries));
}

}  // namespace mica::host
