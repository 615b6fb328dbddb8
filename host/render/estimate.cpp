#include "host/render/estimate.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "host/base/stopwatch.h"
#include "host/render/built_job.h"
#include "host/render/gather_light.h"
#include "host/render/own_samples.h"
#include "host/render/pending_block.h"

namespace mica::host {
namespace {

constexpr int kSampleRows = 48;
constexpr std::size_t kSampleQueries = 8192;
constexpr std::size_t kSamplePoints = 512;  // where light is gathered
constexpr std::size_t kFewestSamples = 64, kSampleShare = 16;

/// As many of all are measured, three times over: never more than rendering asks for.
std::size_t sample_size(std::size_t all, std::size_t most) {
  return std::clamp(all / kSampleShare, kFewestSamples, most);
}

/// Adds every n-th item of one row, so that about `target` are taken of `all` in all rows.
template <typename Item>
void append_some(const std::vector<Item>& row, std::size_t all, std::size_t target,
                 std::vector<Item>* items) {
  const std::size_t stride = all / target + 1;
  for (std::size_t n = 0; n < row.size(); n += stride) items->push_back(row[n]);
}

/// Of some rows of the picture that are traced together: what lies in them, and in the margins around them,
/// whose samples their pixels see, too.
struct ItemsOfRows {
  double a_row = 0, in_margins = 0;
};

/// Items of every block of rows, when each of the sampled ones stands for as many around it.
std::vector<double> items_of_blocks(const std::vector<ItemsOfRows>& sampled, int rows_a_block, int height) {
  std::vector<double> blocks;
  for (int row = 0; row < height; ++row) {
    const ItemsOfRows& items =
        sampled[static_cast<std::size_t>(row) * sampled.size() / static_cast<std::size_t>(height)];
    if (row % rows_a_block == 0) blocks.push_back(items.in_margins);
    blocks.back() += items.a_row;
  }
  return blocks;
}

/// Bytes an item that evaluating takes on the device beside what is there before. They compile on first use,
/// too. Drivers may free what is done with a moment too late, from before the first try or between two: the
/// least that lies there at any time is what stays, and the least peak, where two are alike, is what
/// evaluating takes.
template <typename Evaluate>
double batch_bytes(Device& device, std::size_t items, const Evaluate& evaluate) {
  constexpr int most_tries = 4;
  std::size_t there = device.bytes(), peak = std::numeric_limits<std::size_t>::max();
  bool alike = false;
  for (int attempt = 0; attempt < most_tries && !alike; ++attempt) {
    device.forget_peak();
    evaluate();
    alike = device.peak_bytes() == peak;
    peak = std::min(peak, device.peak_bytes());
    there = std::min(there, device.bytes());
  }
  return static_cast<double>(peak - there) / static_cast<double>(std::max<std::size_t>(items, 1));
}

/// What gathering light in some rows takes.
struct Gathered {
  std::size_t points = 0, queries = 0;
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
    append_some(row.points, all, sample_size(all, kSamplePoints), &sample.points);
    append_some(row.lit, all, sample_size(all, kSamplePoints), &sample.lit);
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
  return {all, static_cast<std::size_t>(scale * static_cast<double>(questions)), scale * watch.seconds(),
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

/// Rows of the picture at equal distances, a few together.
struct SampledRows {
  std::vector<TracedRows> rows;
  std::vector<ItemsOfRows> queries, points;  ///< of each
  std::size_t all_queries = 0;
  double rows_traced = 0, seconds = 0;  ///< with those in margins
};

/// How many items lie in a row of a block, and in its margins.
template <typename Item>
ItemsOfRows items_of(const std::vector<Item>& items, const OwnSamples& own, int rows) {
  const auto inside =
      std::count_if(items.begin(), items.end(), [&](const Item& item) { return own.has(item.sample); });
  return {static_cast<double>(inside) / rows,
          static_cast<double>(items.size()) - static_cast<double>(inside)};
}

SampledRows trace_samples(const Scene& scene, const Job& job) {
  SampledRows sampled;
  const int margin = PixelFilter(job.image.filter).margin_pixels(), height = job.image.height;
  const int together = std::min(margin > 0 ? 2 : 1, height), count = std::min(kSampleRows, height) / together;
  const Stopwatch tracing;
  for (int n = 0; n < count; ++n) {
    const int middle = (2 * n + 1) * height / (2 * count);
    const TracedRows& rows = sampled.rows.emplace_back(
        scene.trace(std::clamp(middle - together / 2, 0, height - together), together));
    const OwnSamples own(rows);
    sampled.queries.push_back(items_of(rows.queries, own, together));
    const ItemsOfRows points = items_of(rows.points, own, together), lit = items_of(rows.lit, own, together);
    sampled.points.push_back({points.a_row + lit.a_row, points.in_margins + lit.in_margins});
    sampled.all_queries += rows.queries.size();
    sampled.rows_traced += together + 2 * margin;
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
    append_some(row.queries, sampled.all_queries, sample_size(sampled.all_queries, kSampleQueries),
                &sample.queries);
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
  const double build_seconds = building.seconds() - built.trace_seconds();
  const SampledRows sampled = trace_samples(built.scene(), job);
  const Gathered gathered = measure_gathering(built, device, sampled.rows);
  const Evaluated evaluated = measure_densities(built, device, sampled);

  const auto of_blocks = [&](const std::vector<ItemsOfRows>& items) {
    return items_of_blocks(items, plan.rows_a_block, job.image.height);
  };
  const std::vector<double> queries = of_blocks(sampled.queries);
  std::vector<double> points = of_blocks(sampled.points);
  const auto sum = [](const std::vector<double>& all) {
    return std::accumulate(all.begin(), all.end(), 0.0);
  };
  const auto share = [](double all, double some) { return some > 0 ? all / some : 0; };
  const double all_queries = sum(queries);
  const double of_device = share(all_queries, static_cast<double>(sampled.all_queries));
  const double of_points = share(sum(points), static_cast<double>(gathered.points));
  const int margin = PixelFilter(job.image.filter).margin_pixels();
  const double rows = job.image.height + 2.0 * margin * static_cast<double>(queries.size());
  const double tracing = sampled.seconds * rows / sampled.rows_traced;
  const double evaluating = of_device * evaluated.device_seconds;
  // A CPU device takes turns with the tracing host, any other works beside it.
  const double work = device.info().is_cpu ? tracing + evaluating : std::max(tracing, evaluating);
  if (plan.gathers_light)  // in batches; see gather_light
    for (double& block : points)
      block = std::min(block, static_cast<double>(plan.queries_a_batch) / job.image.samples);
  const double in_flight =
      most_bytes_in_flight(queries, evaluated.bytes_a_query, points, gathered.bytes_a_point);
  return {static_cast<std::size_t>(all_queries + of_points * static_cast<double>(gathered.queries)),
          build_seconds + work + of_points * gathered.seconds,
          built.device_bytes() + static_cast<std::size_t>(in_flight),
          {built.notes(), built.warnings()}};
}

}  // namespace mica::host
