#include "host/methods/triangles/triangle_evaluator.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "host/base/stopwatch.h"
#include "host/methods/map/map_query.h"

namespace mica::host {

TriangleEvaluator::TriangleEvaluator(Device& device, const Surface& surface, const TriangleSettings& settings)
    : interpolation_(surface.interpolation()), cutoff_(cutoff_for(settings.cutoff_error)) {
  const Stopwatch watch;
  const MapStructure map = build_map_structure(surface);
  build_seconds_ = watch.seconds();
  batches_.emplace(device, map, "triangles/triangles",
                   fmt::format("-DMICA_INTERPOLATION={} -DMICA_COUNT_FLOPS={}",
                               static_cast<int>(interpolation_), static_cast<int>(settings.count_flops)),
                   settings.wave_form.value_or(device.wave_form()), settings.batch_queries);
}

std::unique_ptr<PendingDensities> TriangleEvaluator::start(const std::vector<Query>& queries) {
  std::vector<device_types::mica_map_query> map_queries(queries.size());
  tbb::parallel_for(std::size_t{0}, queries.size(), [&](std::size_t n) {
    map_queries[n] = to_triangle_query(queries[n], batches_->grid(), interpolation_, cutoff_);
  });
  return batches_->start(std::move(map_queries));
}

}  // namespace mica::host
