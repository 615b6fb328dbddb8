#pragma once

#include <memory>
#include <vector>

#include "host/build/moment_pyramid.h"
#include "host/device/device.h"
#include "host/engine/evaluator.h"

namespace mica {

/// One level on the device, and queries fed to it in batches, sorted by where their footprints lie.
class PyramidLevelBatches {
 public:
  /// Uploads the level. `device` must outlive this.
  PyramidLevelBatches(Device& device, const PyramidLevel& level, WaveForm wave_form, bool count_elements,
                      std::size_t batch_queries);

  /// Sends queries, with any slot; densities come in the order of the queries.
  std::unique_ptr<PendingDensities> start(std::vector<device_types::mica_pyramid_query> queries);

  const device_types::mica_pyramid_level& shape() const { return shape_; }
  std::size_t device_bytes() const { return device_bytes_; }
  double device_seconds() const { return *device_seconds_; }

 private:
  class Densities;
  void enqueue(std::size_t first, Densities* pending);

  Device& device_;
  WaveForm wave_form_;
  device_types::mica_pyramid_level shape_;
  std::size_t batch_queries_, device_bytes_;
  std::shared_ptr<double> device_seconds_ = std::make_shared<double>(0.0);  // shared with pending densities
  cl::Buffer groups_, top_nodes_, nodes_, records_;
  cl::Kernel kernel_;
};

}  // namespace mica
