#include "host/methods/map/map_batches.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cstring>
#include <limits>

#include "host/device/launch.h"

namespace mica::host {
namespace {

using device_types::mica_map_query;

std::uint64_t spread_bits(std::uint32_t x) {
  std::uint64_t v = x & 0xffffu;
  v = (v | (v << 8)) & 0x00ff00ffu;
  v = (v | (v << 4)) & 0x0f0f0f0fu;
  v = (v | (v << 2)) & 0x33333333u;
  return (v | (v << 1)) & 0x55555555u;
}

/// Queries one after another, each of which begins with a mica_map_query.
struct QueryBytes {
  const unsigned char* bytes;
  std::size_t query_bytes, count;

  const unsigned char* query(std::size_t n) const { return bytes + n * query_bytes; }
  mica_map_query place(std::size_t n) const {
    mica_map_query place;
    std::memcpy(&place, query(n), sizeof place);
    return place;
  }
};

/// The queries' order by the Morton code of the tile under the mean: neighbours in a batch then read the same
/// texels.
std::vector<std::uint32_t> order_by_footprint(const QueryBytes& queries) {
  std::vector<std::uint64_t> keys(queries.count);  // the code, then the place: equal codes keep their order
  tbb::parallel_for(std::size_t{0}, queries.count, [&](std::size_t n) {
    const mica_map_query place = queries.place(n);
    const std::uint64_t morton = spread_bits(place.mean_i / device_types::MICA_TILE) |
                                 (spread_bits(place.mean_j / device_types::MICA_TILE) << 1);
    keys[n] = morton << 32 | n;
  });
  tbb::parallel_sort(keys);
  std::vector<std::uint32_t> order(queries.count);
  tbb::parallel_for(std::size_t{0}, queries.count,
                    [&](std::size_t n) { order[n] = static_cast<std::uint32_t>(keys[n]); });
  return order;
}

/// @param batch_queries which slots count from zero in.
std::vector<unsigned char> sorted(const QueryBytes& queries, const std::vector<std::uint32_t>& order,
                                  std::size_t batch_queries) {
  std::vector<unsigned char> result(queries.count * queries.query_bytes);
  tbb::parallel_for(std::size_t{0}, queries.count, [&](std::size_t n) {
    unsigned char* const query = result.data() + n * queries.query_bytes;
    const auto slot = static_cast<std::int32_t>(n % batch_queries);
    std::memcpy(query, queries.query(order[n]), queries.query_bytes);
    std::memcpy(query + offsetof(mica_map_query, slot), &slot, sizeof slot);
  });
  return result;
}

}  // namespace

/// Queries on the device, in the order in which they run, and what it takes to put the answers back into
/// theirs.
class QueryBatches::Densities : public PendingDensities {
 public:
  // The device may still be reading and writing our memory when an error unwinds.
  ~Densities() override {
    for (const cl::Event& event : done) clWaitForEvents(1, &event());
  }

  std::vector<float> wait() override {
    reporting("evaluating " + method, [&] {
      if (!done.empty()) cl::Event::waitForEvents(done);
      for (const cl::Event& kernel : kernels) *device_seconds += seconds_of(kernel);
    });
    // A density is not negative: rounding may leave -0 or a denormal, never more. Several numbers are
    // something else, and have signs. What is not finite is the reader's to replace.
    const float least = answers == 1 ? 0.0f : -std::numeric_limits<float>::infinity();
    std::vector<float> ordered(results.size());
    tbb::parallel_for(std::size_t{0}, order.size(), [&](std::size_t n) {
      for (std::size_t k = 0; k < answers; ++k) {
        const float result = results[n * answers + k];
        ordered[order[n] * answers + k] = result < least ? least : result;
      }
    });
    return ordered;
  }

  std::string method;
  std::size_t answers = 1;             // a query
  std::vector<unsigned char> queries;  // alive until the device has read them
  std::vector<std::uint32_t> order;    // of the query at each place
  std::vector<float> results;
  std::vector<cl::Buffer> buffers;  // kept, so that memory does not depend on who is faster, host or device
  std::vector<cl::Event> kernels, done;
  std::shared_ptr<double> device_seconds;
};

QueryBatches::QueryBatches(Device& device, std::size_t query_bytes, const MapStructure& map,
                           const std::string& method, const std::string& options, WaveForm wave_form,
                           std::size_t batch_queries)
    : QueryBatches(device, query_bytes, map.grid,
                   {device.upload(map.normals, "the map's normals"),
                    device.upload(map.block_nodes, "the map's bounds"),
                    device.upload(map.tile_nodes, "the map's bounds")},
                   map.bytes(), method, options, wave_form, batch_queries, 1) {}

QueryBatches::QueryBatches(Device& device, std::size_t query_bytes, const device_types::mica_map_grid& grid,
                           std::vector<cl::Buffer> structure, std::size_t structure_bytes,
                           const std::string& method, const std::string& options, WaveForm wave_form,
                           std::size_t batch_queries, std::size_t answers)
    : device_(device),
      method_(method),
      wave_form_(wave_form),
      grid_(grid),
      query_bytes_(query_bytes),
      batch_queries_(std::clamp<std::size_t>(batch_queries, 1, device.info().allocation_bytes / query_bytes)),
      device_bytes_(structure_bytes),
      answers_(answers),
      structure_(std::move(structure)),
      kernel_(device.kernel(method, options, wave_form)) {}

std::unique_ptr<PendingDensities> QueryBatches::start(const void* queries, std::size_t count) {
  const QueryBytes bytes{static_cast<const unsigned char*>(queries), query_bytes_, count};
  auto pending = std::make_unique<Densities>();
  pending->order = order_by_footprint(bytes);
  pending->method = method_;
  pending->queries = sorted(bytes, pending->order, batch_queries_);
  pending->device_seconds = device_seconds_;
  pending->answers = answers_;
  pending->results.resize(count * answers_);
  for (std::size_t first = 0; first < count; first += batch_queries_)
    enqueue(first, std::min(batch_queries_, count - first), pending.get());
  return pending;
}

void QueryBatches::enqueue(std::size_t first, std::size_t count, Densities* pending) {
  const std::size_t input_bytes = count * query_bytes_, output_bytes = count * answers_ * sizeof(float);
  const cl::Buffer input = device_.buffer(input_bytes, CL_MEM_READ_ONLY, "a batch of queries");
  const cl::Buffer output = device_.buffer(output_bytes, CL_MEM_WRITE_ONLY, "a batch of densities");
  reporting("running " + method_, [&] {
    device_.queue().enqueueWriteBuffer(input, CL_FALSE, 0, input_bytes,
                                       pending->queries.data() + first * query_bytes_);
    cl::Event read_done;
    const cl::Event kernel_done = launch(device_, kernel_, launch_size(wave_form_, count), input,
                                         static_cast<cl_int>(count), grid_, structure_, output);
    device_.queue().enqueueReadBuffer(output, CL_FALSE, 0, output_bytes,
                                      pending->results.data() + first * answers_, nullptr, &read_done);
    pending->buffers.insert(pending->buffers.end(), {input, output});
    pending->kernels.push_back(kernel_done);
    pending->done.push_back(read_done);
    device_.queue().flush();
  });
}

}  // namespace mica::host
