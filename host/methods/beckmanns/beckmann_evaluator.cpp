#include "host/methods/beckmanns/beckmann_evaluator.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "host/base/stopwatch.h"
#include "host/methods/map/first_order.h"
#include "host/methods/map/map_query.h"

namespace mica::host {

BeckmannEvaluator::BeckmannEvaluator(Device& device, const Surface& surface, const MixtureSettings& settings)
    : cutoff_(cutoff_for(settings.cutoff_error)) {
  const Stopwatch watch;
  const LobeStructure lobes = build_lobes(surface, settings.elements);
  build_seconds_ = watch.seconds();
  grid_ = {lobes.grid, lobes.slope_unit, lobes.spread_unit, surface.interpolation(), settings.elements};
  batches_.emplace(device, lobes.grid,
                   std::vector<cl::Buffer>{device.upload(lobes.lobes, "the map's lobes"),
                                           device.upload(lobes.block_nodes, "the map's bounds"),
                                           device.upload(lobes.tile_nodes, "the map's bounds")},
                   lobes.bytes(), "beckmanns/beckmanns",
                   fmt::format("-DMICA_COUNT_ELEMENTS={}", static_cast<int>(settings.count_elements)),
                   settings.wave_form.value_or(device.wave_form()), settings.batch_queries);
}

std::unique_ptr<PendingDensities> BeckmannEvaluator::start(const std::vector<Query>& queries) {
  return start_by_order(
      queries, [this](const std::vector<Query>& some) { return start_plain(some); },
      refuse_first_order("beckmanns"));
}

std::unique_ptr<PendingDensities> BeckmannEvaluator::start_plain(const std::vector<Query>& queries) {
  std::vector<device_types::mica_lobe_query> lobe_queries(queries.size());
  tbb::parallel_for(std::size_t{0}, queries.size(), [&](std::size_t n) {
    lobe_queries[n] = to_lobe_query(queries[n], lobe_weights(queries[n].footprint, grid_), grid_, cutoff_);
  });
  return batches_->start(std::move(lobe_queries));
}

}  // namespace mica::host
