#include "host/methods/pyramid/pyramid_level_batches.h"

#include <fmt/format.h>

namespace mica::host {

PyramidLevelBatches::PyramidLevelBatches(Device& device, const PyramidLevel& level, WaveForm wave_form,
                                         std::size_t batch_queries)
    : device_(device),
      shape_(level.shape),
      wave_form_(wave_form),
      batch_queries_(batch_queries),
      bytes_(level.bytes()),
      buffers_({device.upload(level.groups, "the pyramid's groups"),
                device.upload(level.top_nodes, "the pyramid's bounds"),
                device.upload(level.nodes, "the pyramid's bounds"),
                device.upload(level.records, "the pyramid's elements")}),
      batches_(make_batches(false)) {}

std::unique_ptr<PendingDensities> PyramidLevelBatches::start_count(
    std::vector<device_types::mica_pyramid_query> queries) {
  if (!counting_) counting_.emplace(make_batches(true));
  return counting_->start(std::move(queries));
}

std::unique_ptr<PendingDensities> PyramidLevelBatches::start_turned(
    std::vector<device_types::mica_turned_pyramid_query> queries) {
  if (!turned_)
    turned_.emplace(device_, shape_.grid, buffers_, bytes_, "pyramid/pyramid",
                    fmt::format("-DMICA_RECORD_BITS={} -DMICA_FIRST_ORDER=1", shape_.record_bits), wave_form_,
                    batch_queries_);
  return turned_->start(std::move(queries));
}

PyramidLevelBatches::Batches PyramidLevelBatches::make_batches(bool count_elements) const {
  return Batches(device_, shape_.grid, buffers_, bytes_, "pyramid/pyramid",
                 fmt::format("-DMICA_RECORD_BITS={} -DMICA_COUNT_ELEMENTS={}", shape_.record_bits,
                             static_cast<int>(count_elements)),
                 wave_form_, batch_queries_);
}

}  // namespace mica::host
