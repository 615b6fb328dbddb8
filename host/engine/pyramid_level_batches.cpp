#include "host/engine/pyramid_level_batches.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>

namespace mica {
namespace {

using device_types::mica_pyramid_query;

constexpr std::size_t kWaveLanes = 16;
constexpr std::size_t kCpuGroup = 16;  // queries a work-group on a CPU
constexpr int kSortSquares = 64;  // of a group's side: footprints in one square are neighbours in a batch

std::uint64_t spread_bits(std::uint32_t x) {
  std::uint64_t v = x & 0xffffu;
  v = (v | (v << 8)) & 0x00ff00ffu;
  v = (v | (v << 4)) & 0x0f0f0f0fu;
  v = (v | (v << 2)) & 0x33333333u;
  return (v | (v << 1)) & 0x55555555u;
}

/// Places of the queries in the order in which they run: by the Morton code of the square under their mean.
std::vector<std::uint32_t> running_order(const std::vector<mica_pyramid_query>& queries, int group_size) {
  struct Key {
    std::uint64_t code;
    std::uint32_t index;
  };
  const int square = std::max(group_size / kSortSquares, 1);
  std::vector<Key> keys(queries.size());
  tbb::parallel_for(std::size_t{0}, keys.size(), [&](std::size_t n) {
    const std::uint64_t morton =
        spread_bits(queries[n].map.mean_i / square) | (spread_bits(queries[n].map.mean_j / square) << 1);
    keys[n] = {morton, static_cast<std::uint32_t>(n)};
  });
  tbb::parallel_sort(keys, [](const Key& a, const Key& b) {
    return a.code != b.code ? a.code < b.code : a.index < b.index;
  });
  std::vector<std::uint32_t> order(keys.size());
  std::transform(keys.begin(), keys.end(), order.begin(), [](const Key& key) { return key.index; });
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

class PyramidLevelBatches::Densities : public PendingDensities {
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
      throw opencl_error(error, "evaluating pyramid");
    }
    std::vector<float> ordered(results.size());
    for (std::size_t n = 0; n < results.size(); ++n) {
      if (!std::isfinite(results[n])) throw DeviceError("evaluating pyramid: a density is not finite");
      ordered[order[n]] = std::max(results[n], 0.0f);
    }
    return ordered;
  }

  std::vector<mica_pyramid_query> queries;  // alive until the device has read them
  std::vector<std::uint32_t> order;
  std::vector<float> results;
  std::vector<cl::Event> kernels, done;
  std::shared_ptr<double> device_seconds;
};

PyramidLevelBatches::PyramidLevelBatches(Device& device, const PyramidLevel& level, WaveForm wave_form,
                                         bool count_elements, std::size_t batch_queries)
    : device_(device),
      wave_form_(wave_form),
      shape_(level.shape),
      batch_queries_(std::clamp<std::size_t>(batch_queries, 1,
                                             device.info().allocation_bytes / sizeof(mica_pyramid_query))),
      device_bytes_(level.bytes()),
      groups_(device.upload(level.groups, "the pyramid's groups")),
      top_nodes_(device.upload(level.top_nodes, "the pyramid's bounds")),
      nodes_(device.upload(level.nodes, "the pyramid's bounds")),
      records_(device.upload(level.records, "the pyramid's elements")),
      kernel_(device.kernel("pyramid.cl", "pyramid",
                            fmt::format("-DMICA_COUNT_ELEMENTS={}", static_cast<int>(count_elements)),
                            wave_form)) {}

std::unique_ptr<PendingDensities> PyramidLevelBatches::start(std::vector<mica_pyramid_query> queries) {
  auto pending = std::make_unique<Densities>();
  pending->device_seconds = device_seconds_;
  pending->order = running_order(queries, shape_.group_size);
  const std::size_t count = queries.size();
  pending->results.resize(count);
  pending->queries.resize(count);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t n) {
    pending->queries[n] = queries[pending->order[n]];
    pending->queries[n].map.slot = static_cast<std::int32_t>(n % batch_queries_);
  });
  for (std::size_t first = 0; first < count; first += batch_queries_) enqueue(first, pending.get());
  return pending;
}

void PyramidLevelBatches::enqueue(std::size_t first, Densities* pending) {
  const std::size_t count = std::min(batch_queries_, pending->queries.size() - first);
  const cl::Buffer input =
      device_.buffer(count * sizeof(mica_pyramid_query), CL_MEM_READ_ONLY, "a batch of queries");
  const cl::Buffer output = device_.buffer(count * sizeof(float), CL_MEM_WRITE_ONLY, "a batch of densities");
  try {
    device_.queue().enqueueWriteBuffer(input, CL_FALSE, 0, count * sizeof(mica_pyramid_query),
                                       pending->queries.data() + first);
    kernel_.setArg(0, input);
    kernel_.setArg(1, static_cast<cl_int>(count));
    kernel_.setArg(2, sizeof shape_, &shape_);
    kernel_.setArg(3, groups_);
    kernel_.setArg(4, top_nodes_);
    kernel_.setArg(5, nodes_);
    kernel_.setArg(6, records_);
    kernel_.setArg(7, output);
    const bool vectors = wave_form_ == WaveForm::vectors;
    const std::size_t global = vectors ? round_up(count, kCpuGroup) : count * kWaveLanes;
    cl::Event kernel_done, read_done;
    device_.queue().enqueueNDRangeKernel(kernel_, cl::NullRange, global, vectors ? kCpuGroup : kWaveLanes,
                                         nullptr, &kernel_done);
    device_.queue().enqueueReadBuffer(output, CL_FALSE, 0, count * sizeof(float),
                                      pending->results.data() + first, nullptr, &read_done);
    pending->kernels.push_back(kernel_done);
    pending->done.push_back(read_done);
    device_.queue().flush();
  } catch (const cl::Error& error) {
    throw opencl_error(error, "running pyramid");
  }
}

}  // namespace mica
