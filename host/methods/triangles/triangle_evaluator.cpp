#include "host/methods/triangles/triangle_evaluator.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "host/base/stopwatch.h"
#include "host/methods/map/first_order.h"
#include "host/methods/map/map_query.h"
#include "host/methods/map/turned_query.h"

namespace mica::host {

namespace {

std::string triangle_options(Interpolation interpolation, const TriangleSettings& settings, int level,
                             bool first_order) {
  return fmt::format(
      "-DMICA_INTERPOLATION={} -DMICA_COUNT_FLOPS={} -DMICA_FIRST_ORDER={} -DMICA_PRECISION={}",
      static_cast<int>(interpolation), static_cast<int>(settings.count_flops), static_cast<int>(first_order),
      level);
}

}  // namespace

TriangleEvaluator::TriangleEvaluator(Device& device, const Surface& surface, const TriangleSettings& settings)
    : device_(device),
      settings_(settings),
      interpolation_(surface.interpolation()),
      precision_(triangle_precision(settings.tolerance)) {
  const Stopwatch watch;
  const MapStructure map = build_map_structure(surface);
  build_seconds_ = watch.seconds();
  batches_.emplace(device, map, "triangles/triangles",
                   triangle_options(interpolation_, settings, precision_.level, false),
                   settings.wave_form.value_or(device.wave_form()), settings.batch_queries);
}

TriangleEvaluator::TriangleEvaluator(Device& device, const TriangleEvaluator& same_map,
                                     const TriangleSettings& settings)
    : device_(device),
      settings_(settings),
      interpolation_(same_map.interpolation_),
      precision_(triangle_precision(settings.tolerance)) {
  batches_.emplace(device, same_map.batches_->grid(), same_map.batches_->structure(), 0,
                   "triangles/triangles", triangle_options(interpolation_, settings, precision_.level, false),
                   settings.wave_form.value_or(device.wave_form()), settings.batch_queries);
}

std::unique_ptr<PendingDensities> TriangleEvaluator::start(const std::vector<Query>& queries) {
  return start_by_order(
      queries, [this](const std::vector<Query>& some) { return start_plain(some); },
      [this](const std::vector<Query>& some) { return start_turned(some); });
}

std::unique_ptr<PendingDensities> TriangleEvaluator::start_plain(const std::vector<Query>& queries) {
  std::vector<device_types::mica_map_query> map_queries(queries.size());
  tbb::parallel_for(std::size_t{0}, queries.size(), [&](std::size_t n) {
    map_queries[n] = to_triangle_query(queries[n], batches_->grid(), interpolation_, precision_.cutoff);
    map_queries[n].scale *= static_cast<float>(1 / precision_.kept);
  });
  return batches_->start(std::move(map_queries));
}

std::unique_ptr<PendingDensities> TriangleEvaluator::start_turned(const std::vector<Query>& queries) {
  if (!turned_)
    turned_.emplace(device_, batches_->grid(), batches_->structure(), batches_->device_bytes(),
                    "triangles/triangles",
                    triangle_options(interpolation_, settings_, precision_.level, true),
                    settings_.wave_form.value_or(device_.wave_form()), settings_.batch_queries);
  std::vector<device_types::mica_turned_query> turned_queries(queries.size());
  tbb::parallel_for(std::size_t{0}, queries.size(), [&](std::size_t n) {
    turned_queries[n] =
        to_turned_triangle_query(queries[n], batches_->grid(), interpolation_, precision_.cutoff);
    turned_queries[n].map.scale *= static_cast<float>(1 / precision_.kept);
  });
  return turned_->start(std::move(turned_queries));
}

double TriangleEvaluator::device_seconds() const {
  return batches_->device_seconds() + (turned_ ? turned_->device_seconds() : 0);
}

}  // namespace mica::host
