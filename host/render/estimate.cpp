#include "host/render/estimate.h"

#include <algorithm>
#include <limits>

#include "host/base/stopwatch.h"
#include "host/render/built_job.h"
#include "host/render/gather_light.h"

namespace mica::host {
namespace {

constexpr int kSampleRows = 48;
constexpr std::size_t kSampleQueries = 8192;
constexpr std::size_t kSamplePoints = 512;  // where light is gathered

/// Adds every n-th item of one row, so that about `target` are taken of `all` in all rows.
template <typename Item>
void append_some(const std::vector<Item>& row, std::size_t all, std::size_t target,
                 std::vector<Item>* items) {
  const std::size_t stride = all / target + 1;
  for (std::size_t n = 0; n < row.size(); n += stride) items->push_back(row[n]);
}

/// Items of every block of rows, when each of `sampled` rows stands for as many around it.
std::vector<double> items_of_blocks(const std::vector<std::size_t>& sampled, int rows_a_block, int height) {
  std::vector<double> blocks;
  for (int row = 0; row < height; ++row) {
    if (row % rows_a_block == 0) blocks.push_back(0);
    blocks.back() += static_cast<double>(sampled[row * sampled.size() / height]);
  }
  return blocks;
}

/// Bytes an item that evaluating takes on the device beside what is there before: the lesser of two tries,
/// since drivers may free what is done with a moment too late. They compile on first use, too.
template <typename Evaluate>
double batch_bytes(Device& device, std::size_t items, const Evaluate& evaluate) {
  std::size_t least = std::numeric_limits<std::size_t>::max();
  for (int attempt = 0; attempt < 2; ++attempt) {
    const std::size_t before = device.bytes();
    device.forget_peak();
    evaluate();
    least = std::min(least, device.peak_bytes() - before);
  }
  return static_cast<double>(least) / static_cast<double>(std::max<std::size_t>(items, 1));
}

/// What gathering light in some rows takes.
struct Gathered {
  std::size_t queries = 0;
  double seconds = 0, bytes_a_point = 0;
};

/// Measures a few of the rows' points, all at a time.
Gathered measure_gathering(const BuiltJob& built, Device& device, const std::vector<TracedRows>& rows) {
  std::size_t all = 0;
  for (const TracedRows& row : rows) all += row.points.size() + row.lit.size();
  if (!all) return {};
  TracedRows sample = rows.front();
  sample.points.clear(), sample.lit.clear();
  for (const TracedRows& row : rows) {
    if (row.sample_radiance.size() > sample.sample_radiance.size())
      sample.sample_radiance = row.sample_radiance;  // all samples have their place
    append_some(row.points, all, kSamplePoints, &sample.points);
    append_some(row.lit, all, kSamplePoints, &sample.lit);
  }
  const std::size_t measured = sample.points.size() + sample.lit.size();
  const auto gather = [&] {
    TracedRows copy = sample;  // gathering empties it
    return add_lit_brdfs(built, &copy) + gather_light(built, &copy);
  };
  const double bytes_a_point = batch_bytes(device, measured, gather);
  const Stopwatch watch;
  const std::size_t questions = gather();
  const double scale = static_cast<double>(all) / static_cast<double>(measured);
  return {static_cast<std::size_t>(scale * static_cast<double>(questions)), scale * watch.seconds(),
          bytes_a_point};
}

/// Of the batches that are on the device together: those of a block, and of the one after or its gathering.
double most_bytes_in_flight(const std::vector<double>& queries, double bytes_a_query,
                            const std::vector<double>& points, double bytes_a_point) {
  double most = 0, before = 0;
  for (std::size_t block = 0; block < queries.size(); ++block) {
    const double evaluated = bytes_a_query * queries[block];
    most = std::max(most, before + std::max(evaluated, bytes_a_point * points[block]));
    before = evaluated;
  }
  return most;
}

/// Rows of the picture at equal distances, traced one by one.
struct SampledRows {
  std::vector<TracedRows> rows;
  std::vector<std::size_t> queries, points;  ///< of every row
  std::size_t all_queries = 0;
  double seconds = 0;
};

SampledRows trace_samples(const Scene& scene, int height) {
  SampledRows sampled;
  const int count = std::min(kSampleRows, height);
  const Stopwatch tracing;
  for (int n = 0; n < count; ++n) {
    const TracedRows& row = sampled.rows.emplace_back(scene.trace((2 * n + 1) * height / (2 * count), 1));
    sampled.queries.push_back(row.queries.size());
    sampled.points.push_back(row.points.size() + row.lit.size());
    sampled.all_queries += row.queries.size();
  }
  sampled.seconds = tracing.seconds();
  return sampled;
}

/// What evaluating the densities of the sampled rows takes.
struct Evaluated {
  double device_seconds = 0, bytes_a_query = 0;
};

/// Measures a few of the rows' queries, in one batch.
Evaluated measure_densities(const BuiltJob& built, Device& device, const SampledRows& sampled) {
  TracedRows sample;
  for (const TracedRows& row : sampled.rows)
    append_some(row.queries, sampled.all_queries, kSampleQueries, &sample.queries);
  const std::size_t count = sample.queries.size();
  if (!count) return {};
  const auto evaluate = [&] { PendingBlock(sample, built).wait(); };
  const double bytes_a_query = batch_bytes(device, count, evaluate);
  const double before = built.device_seconds();
  evaluate();
  const double scale = static_cast<double>(sampled.all_queries) / static_cast<double>(count);
  return {scale * (built.device_seconds() - before), bytes_a_query};
}

}  // namespace

Estimate estimate(const Job& job, const Plan& plan, Device& device) {
  const Stopwatch building;
  const BuiltJob built(job, plan, device);
  const double build_seconds = building.seconds();
  const SampledRows sampled = trace_samples(built.scene(), job.image.height);
  const Gathered gathered = measure_gathering(built, device, sampled.rows);
  const Evaluated evaluated = measure_densities(built, device, sampled);

  const double scale = static_cast<double>(job.image.height) / static_cast<double>(sampled.rows.size());
  // A CPU device takes turns with the tracing host, any other works beside it.
  const double work = device.info().is_cpu ? sampled.seconds + evaluated.device_seconds
                                           : std::max(sampled.seconds, evaluated.device_seconds);
  const auto of_blocks = [&](const std::vector<std::size_t>& items) {
    return items_of_blocks(items, plan.rows_a_block, job.image.height);
  };
  std::vector<double> points = of_blocks(sampled.points);
  if (plan.gathers_light)  // in batches; see gather_light
    for (double& block : points)
      block = std::min(block, static_cast<double>(plan.queries_a_batch) / job.image.samples);
  const double in_flight = most_bytes_in_flight(of_blocks(sampled.queries), evaluated.bytes_a_query, points,
                                                gathered.bytes_a_point);
  return {static_cast<std::size_t>(scale * static_cast<double>(sampled.all_queries + gathered.queries)),
          build_seconds + scale * (work + gathered.seconds),
          built.device_bytes() + static_cast<std::size_t>(in_flight),
          {built.notes(), built.warnings()}};
}

}  // namespace mica::host
