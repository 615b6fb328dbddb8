#include "host/methods/map/map_batches.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace mica::host {
namespace {

using device_types::mica_cavity_query;
using device_types::mica_lobe_query;
using device_types::mica_map_query;
using device_types::mica_mixture_query;
using device_types::mica_patch_query;
using device_types::mica_pyramid_query;
using device_types::mica_smooth_query;
using device_types::mica_turned_mixture_query;
using device_types::mica_turned_pyramid_query;
using device_types::mica_turned_query;
using device_types::mica_turned_smooth_query;

constexpr std::size_t kCpuGroup = 16;  // queries a work-group on a CPU

std::uint64_t spread_bits(std::uint32_t x) {
  std::uint64_t v = x & 0xffffu;
  v = (v | (v << 8)) & 0x00ff00ffu;
  v = (v | (v << 4)) & 0x0f0f0f0fu;
  v = (v | (v << 2)) & 0x33333333u;
  return (v | (v << 1)) & 0x55555555u;
}

mica_map_query& place_of(mica_map_query& query) {
  return query;
}
mica_map_query& place_of(mica_mixture_query& query) {
  return query.map;
}
mica_map_query& place_of(mica_lobe_query& query) {
  return query.map;
}
mica_map_query& place_of(mica_cavity_query& query) {
  return query.map;
}
mica_map_query& place_of(mica_patch_query& query) {
  return query.lobe.map;
}
mica_map_query& place_of(mica_pyramid_query& query) {
  return query.map;
}
mica_map_query& place_of(mica_smooth_query& query) {
  return query.map;
}
mica_map_query& place_of(mica_turned_query& query) {
  return query.map;
}
mica_map_query& place_of(mica_turned_mixture_query& query) {
  return query.mixture.map;
}
mica_map_query& place_of(mica_turned_pyramid_query& query) {
  return query.pyramid.map;
}
mica_map_query& place_of(mica_turned_smooth_query& query) {
  return query.smooth.map;
}

/// Sorts by the Morton code of the tile under the mean: neighbours in a batch then read the same texels.
/// @return each one's place before. @param batch_queries which slots count from zero in.
template <typename DeviceQuery>
std::vector<std::uint32_t> sort_by_footprint(std::size_t batch_queries, std::vector<DeviceQuery>* queries) {
  const std::size_t count = queries->size();
  std::vector<std::uint64_t> keys(count);  // the code, then the place: equal codes keep their order
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t n) {
    const mica_map_query& q = place_of((*queries)[n]);
    const std::uint64_t morton = spread_bits(q.mean_i / device_types::MICA_TILE) |
                                 (spread_bits(q.mean_j / device_types::MICA_TILE) << 1);
    keys[n] = morton << 32 | n;
  });
  tbb::parallel_sort(keys);
  std::vector<DeviceQuery> sorted(count);
  std::vector<std::uint32_t> order(count);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t n) {
    order[n] = static_cast<std::uint32_t>(keys[n]);
    sorted[n] = (*queries)[order[n]];
    place_of(sorted[n]).slot = static_cast<std::int32_t>(n % batch_queries);
  });
  queries->swap(sorted);
  return order;
}

double seconds_of(const cl::Event& event) {
  return 1e-9 * static_cast<double>(event.getProfilingInfo<CL_PROFILING_COMMAND_END>() -
                                    event.getProfilingInfo<CL_PROFILING_COMMAND_START>());
}

std::size_t round_up(std::size_t n, std::size_t multiple) {
  return (n + multiple - 1) / multiple * multiple;
}

}  // namespace

/// Queries on the device, in the order in which they run, and what it takes to put the answers back into
/// theirs.
template <typename DeviceQuery>
class MapBatches<DeviceQuery>::Densities : public PendingDensities {
 public:
  // The device may still be reading and writing our memory when an error unwinds.
  ~Densities() override {
    for (const cl::Event& event : done) clWaitForEvents(1, &event());
  }

  std::vector<float> wait() override {
    try {
      if (!done.empty()) cl::Event::waitForEvents(done);
      for (const cl::Event& kernel : kernels) *device_seconds += seconds_of(kernel);
    } catch (const cl::Error& error) {
      throw opencl_error(error, "evaluating " + method);
    }
    // A density is finite and not negative: rounding may leave -0 or a denormal, never more. Several numbers
    // are something else, and have signs.
    const float least = answers == 1 ? 0.0f : -std::numeric_limits<float>::infinity();
    std::vector<float> ordered(results.size());
    tbb::parallel_for(std::size_t{0}, order.size(), [&](std::size_t n) {
      for (std::size_t k = 0; k < answers; ++k) {
        const float result = results[n * answers + k];
        if (!std::isfinite(result)) throw DeviceError("evaluating " + method + ": a density is not finite");
        ordered[order[n] * answers + k] = std::max(result, least);
      }
    });
    return ordered;
  }

  std::string method;
  std::size_t answers = 1;           // a query
  std::vector<DeviceQuery> queries;  // alive until the device has read them
  std::vector<std::uint32_t> order;  // of the query at each place
  std::vector<float> results;
  std::vector<cl::Buffer> buffers;  // kept, so that memory does not depend on who is faster, host or device
  std::vector<cl::Event> kernels, done;
  std::shared_ptr<double> device_seconds;
};

template <typename DeviceQuery>
MapBatches<DeviceQuery>::MapBatches(Device& device, const MapStructure& map, const std::string& method,
                                    const std::string& options, WaveForm wave_form, std::size_t batch_queries)
    : MapBatches(device, map.grid,
                 {device.upload(map.normals, "the map's normals"),
                  device.upload(map.block_nodes, "the map's bounds"),
                  device.upload(map.tile_nodes, "the map's bounds")},
                 map.bytes(), method, options, wave_form, batch_queries) {}

template <typename DeviceQuery>
MapBatches<DeviceQuery>::MapBatches(Device& device, const device_types::mica_map_grid& grid,
                                    std::vector<cl::Buffer> structure, std::size_t bytes,
                                    const std::string& method, const std::string& options, WaveForm wave_form,
                                    std::size_t batch_queries, std::size_t answers)
    : device_(device),
      method_(method),
      wave_form_(wave_form),
      grid_(grid),
      batch_queries_(
          std::clamp<std::size_t>(batch_queries, 1, device.info().allocation_bytes / sizeof(DeviceQuery))),
      device_bytes_(bytes),
      answers_(answers),
      structure_(std::move(structure)),
      kernel_(device.kernel(method, options, wave_form)) {}

template <typename DeviceQuery>
std::unique_ptr<PendingDensities> MapBatches<DeviceQuery>::start(std::vector<DeviceQuery> queries) {
  auto pending = std::make_unique<Densities>();
  pending->order = sort_by_footprint(batch_queries_, &queries);
  pending->method = method_;
  pending->queries = std::move(queries);
  pending->device_seconds = device_seconds_;
  const std::size_t count = pending->queries.size();
  pending->answers = answers_;
  pending->results.resize(count * answers_);
  for (std::size_t first = 0; first < count; first += batch_queries_) enqueue(first, pending.get());
  return pending;
}

template <typename DeviceQuery>
void MapBatches<DeviceQuery>::enqueue(std::size_t first, Densities* pending) {
  const std::vector<DeviceQuery>& queries = pending->queries;
  const std::size_t count = std::min(batch_queries_, queries.size() - first);
  const cl::Buffer input =
      device_.buffer(count * sizeof(DeviceQuery), CL_MEM_READ_ONLY, "a batch of queries");
  const std::size_t output_bytes = count * answers_ * sizeof(float);
  const cl::Buffer output = device_.buffer(output_bytes, CL_MEM_WRITE_ONLY, "a batch of densities");
  try {
    device_.queue().enqueueWriteBuffer(input, CL_FALSE, 0, count * sizeof(DeviceQuery),
                                       queries.data() + first);
    kernel_.setArg(0, input);
    kernel_.setArg(1, static_cast<cl_int>(count));
    kernel_.setArg(2, sizeof grid_, &grid_);
    cl_uint argument = 3;
    for (const cl::Buffer& buffer : structure_) kernel_.setArg(argument++, buffer);
    kernel_.setArg(argument, output);
    const bool vectors = wave_form_ == WaveForm::vectors;
    const std::size_t global = vectors ? round_up(count, kCpuGroup) : count * kWaveLanes;
    const std::size_t local = vectors ? kCpuGroup : kWaveLanes;
    cl::Event kernel_done, read_done;
    device_.queue().enqueueNDRangeKernel(kernel_, cl::NullRange, global, local, nullptr, &kernel_done);
    device_.queue().enqueueReadBuffer(output, CL_FALSE, 0, output_bytes,
                                      pending->results.data() + first * answers_, nullptr, &read_done);
    pending->buffers.insert(pending->buffers.end(), {input, output});
    pending->kernels.push_back(kernel_done);
    pending->done.push_back(read_done);
    device_.queue().flush();
  } catch (const cl::Error& error) {
    throw opencl_error(error, "running " + method_);
  }
}

template class MapBatches<mica_map_query>;
template class MapBatches<mica_mixture_query>;
template class MapBatches<mica_lobe_query>;
template class MapBatches<mica_cavity_query>;
template class MapBatches<mica_patch_query>;
template class MapBatches<mica_pyramid_query>;
template class MapBatches<mica_smooth_query>;
template class MapBatches<mica_turned_query>;
template class MapBatches<mica_turned_mixture_query>;
template class MapBatches<mica_turned_pyramid_query>;
template class MapBatches<mica_turned_smooth_query>;

}  // namespace mica::host
