#pragma once

#include <memory>
#include <string>
#include <vector>

#include "host/device/device.h"
#include "host/methods/evaluator.h"
#include "host/methods/map/map_structure.h"
#include "kernels/pyramid/pyramid_types.h"
#include "kernels/types.h"

namespace mica::host {

/// What every kernel on a map's structure needs to run: its buffers on the device, and queries fed in
/// batches, sorted by where their footprints lie.
/// @tparam DeviceQuery mica_map_query, or a struct that begins with one.
template <typename DeviceQuery>
class MapBatches {
 public:
  /// Uploads `map`. `device` must outlive this.
  /// @param method path of the kernel: "triangles/triangles", see Device::kernel.
  /// @param options compiler options.
  /// @param batch_queries queries a launch, at most; less where the device's memory asks for it.
  MapBatches(Device& device, const MapStructure& map, const std::string& method, const std::string& options,
             WaveForm wave_form, std::size_t batch_queries);

  /// The same for a kernel with other buffers between the grid and the densities.
  /// @param structure its buffers, in the order of its arguments; @param bytes of all of them.
  /// @param answers floats a query that the kernel writes, to density[slot * answers] and on; negative ones
  /// only where there are several.
  MapBatches(Device& device, const device_types::mica_map_grid& grid, std::vector<cl::Buffer> structure,
             std::size_t bytes, const std::string& method, const std::string& options, WaveForm wave_form,
             std::size_t batch_queries, std::size_t answers = 1);

  /// Sends queries, in any order and with any slot. Answers come in the order of the queries.
  std::unique_ptr<PendingDensities> start(std::vector<DeviceQuery> queries);

  /// The structure on the device: another kernel may share it.
  const std::vector<cl::Buffer>& structure() const { return structure_; }
  const device_types::mica_map_grid& grid() const { return grid_; }
  std::size_t device_bytes() const { return device_bytes_; }
  double device_seconds() const { return *device_seconds_; }

 private:
  class Densities;
  void enqueue(std::size_t first, Densities* pending);

  Device& device_;
  std::string method_;
  WaveForm wave_form_;
  device_types::mica_map_grid grid_;
  std::size_t batch_queries_, device_bytes_, answers_;
  std::shared_ptr<double> device_seconds_ = std::make_shared<double>(0.0);  // shared with pending densities
  std::vector<cl::Buffer> structure_;
  cl::Kernel kernel_;
};

extern template class MapBatches<device_types::mica_map_query>;
extern template class MapBatches<device_types::mica_mixture_query>;
extern template class MapBatches<device_types::mica_lobe_query>;
extern template class MapBatches<device_types::mica_cavity_query>;
extern template class MapBatches<device_types::mica_patch_query>;
extern template class MapBatches<device_types::mica_pyramid_query>;
extern template class MapBatches<device_types::mica_smooth_query>;
extern template class MapBatches<device_types::mica_turned_query>;
extern template class MapBatches<device_types::mica_turned_mixture_query>;
extern template class MapBatches<device_types::mica_turned_pyramid_query>;
extern template class MapBatches<device_types::mica_turned_smooth_query>;

}  // namespace mica::host
