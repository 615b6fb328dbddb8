#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "host/device/device.h"
#include "host/methods/evaluator.h"
#include "host/methods/map/map_batches.h"
#include "host/methods/pyramid/moment_pyramid.h"
#include "kernels/pyramid/pyramid_types.h"

namespace mica::host {

/// One level on the device, and queries fed to it in batches.
class PyramidLevelBatches {
 public:
  /// Uploads the level. `device` must outlive this.
  PyramidLevelBatches(Device& device, const PyramidLevel& level, WaveForm wave_form,
                      std::size_t batch_queries);

  /// Sends queries, with any slot; densities come in the order of the queries.
  std::unique_ptr<PendingDensities> start(std::vector<device_types::mica_pyramid_query> queries) {
    return batches_.start(std::move(queries));
  }

  /// The same, with the numbers of elements summed in place of densities.
  std::unique_ptr<PendingDensities> start_count(std::vector<device_types::mica_pyramid_query> queries);

  /// The same of queries with a first order.
  std::unique_ptr<PendingDensities> start_turned(
      std::vector<device_types::mica_turned_pyramid_query> queries);

  const PyramidShape& shape() const { return shape_; }
  /// In the order of the kernels' arguments: groups, top nodes, nodes, records.
  const std::vector<cl::Buffer>& buffers() const { return buffers_; }
  std::size_t device_bytes() const { return batches_.device_bytes(); }
  double device_seconds() const {
    return batches_.device_seconds() + (turned_ ? turned_->device_seconds() : 0);
  }

 private:
  using Batches = MapBatches<device_types::mica_pyramid_query>;
  Batches make_batches(bool count_elements) const;

  Device& device_;
  PyramidShape shape_;
  WaveForm wave_form_;
  std::size_t batch_queries_, bytes_;
  std::vector<cl::Buffer> buffers_;
  Batches batches_;
  std::optional<Batches> counting_;  // on the same buffers
  std::optional<MapBatches<device_types::mica_turned_pyramid_query>> turned_;
};

}  // namespace mica::host
