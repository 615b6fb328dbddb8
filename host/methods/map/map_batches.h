#pragma once

#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "host/device/device.h"
#include "host/methods/evaluator.h"
#include "host/methods/map/map_structure.h"
#include "kernels/types.h"

namespace mica::host {

/// MapBatches of queries of any type, as bytes: all that can be compiled once.
class QueryBatches {
 public:
  /// @param query_bytes of a query, which begins with a mica_map_query; the others as those of MapBatches.
  QueryBatches(Device& device, std::size_t query_bytes, const device_types::mica_map_grid& grid,
               std::vector<cl::Buffer> structure, std::size_t structure_bytes, const std::string& method,
               const std::string& options, WaveForm wave_form, std::size_t batch_queries,
               std::size_t answers);
  QueryBatches(Device& device, std::size_t query_bytes, const MapStructure& map, const std::string& method,
               const std::string& options, WaveForm wave_form, std::size_t batch_queries);

  const device_types::mica_map_grid& grid() const { return grid_; }
  /// The structure on the device: another kernel may share it.
  const std::vector<cl::Buffer>& structure() const { return structure_; }
  std::size_t device_bytes() const { return device_bytes_; }
  double device_seconds() const { return *device_seconds_; }

 protected:
  /// @param queries are copied.
  std::unique_ptr<PendingDensities> start(const void* queries, std::size_t count);

 private:
  class Densities;
  void enqueue(std::size_t first, std::size_t count, Densities* pending);

  Device& device_;
  std::string method_;
  WaveForm wave_form_;
  device_types::mica_map_grid grid_;
  std::size_t query_bytes_, batch_queries_, device_bytes_, answers_;
  std::shared_ptr<double> device_seconds_ = std::make_shared<double>(0.0);  // shared with pending densities
  std::vector<cl::Buffer> structure_;
  cl::Kernel kernel_;
};

/// What every kernel on a map's structure needs to run: its buffers on the device, and queries fed in
/// batches, sorted by where their footprints lie.
/// @tparam DeviceQuery mica_map_query, or a struct that begins with one.
template <typename DeviceQuery>
class MapBatches : public QueryBatches {
  static_assert(std::is_standard_layout_v<DeviceQuery> && std::is_trivially_copyable_v<DeviceQuery>);

 public:
  /// Uploads `map`. `device` must outlive this.
  /// @param method path of the kernel: "triangles/triangles", see Device::kernel.
  /// @param options compiler options.
  /// @param batch_queries queries a launch, at most; less where the device's memory asks for it.
  MapBatches(Device& device, const MapStructure& map, const std::string& method, const std::string& options,
             WaveForm wave_form, std::size_t batch_queries)
      : QueryBatches(device, sizeof(DeviceQuery), map, method, options, wave_form, batch_queries) {}

  /// For a kernel with other buffers between the grid and the densities.
  /// @param structure its buffers, in the order of its arguments; @param bytes of all of them.
  /// @param answers floats a query that the kernel writes, to density[slot * answers] and on; negative ones
  /// only where there are several.
  MapBatches(Device& device, const device_types::mica_map_grid& grid, std::vector<cl::Buffer> structure,
             std::size_t bytes, const std::string& method, const std::string& options, WaveForm wave_form,
             std::size_t batch_queries, std::size_t answers = 1)
      : QueryBatches(device, sizeof(DeviceQuery), grid, std::move(structure), bytes, method, options,
                     wave_form, batch_queries, answers) {}

  /// Sends queries, in any order and with any slot. Answers come in the order of the queries.
  std::unique_ptr<PendingDensities> start(std::vector<DeviceQuery> queries) {
    return QueryBatches::start(queries.data(), queries.size());
  }
};

}  // namespace mica::host
