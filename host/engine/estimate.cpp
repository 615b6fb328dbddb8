#include "host/engine/estimate.h"

#include <algorithm>

#include "host/base/stopwatch.h"
#include "host/engine/built_job.h"
#include "host/engine/gather_light.h"

namespace mica {
namespace {

constexpr int kSampleRows = 24;
constexpr std::size_t kSampleQueries = 8192;
constexpr std::size_t kSamplePoints = 512;  // where light is gathered

/// Keeps every n-th item of one row, so that about `target` are left of `all` in all rows.
template <typename Item>
void thin(std::size_t all, std::size_t target, std::vector<Item>* items) {
  const std::size_t stride = all / target + 1;
  std::vector<Item> kept;
  for (std::size_t n = 0; n < items->size(); n += stride) kept.push_back((*items)[n]);
  items->swap(kept);
}

/// What gathering light in some rows takes.
struct Gathered {
  std::size_t queries = 0;
  double seconds = 0;
};

/// Measures a few of the rows' points, of which it leaves nothing.
Gathered measure_gathering(const BuiltJob& built, std::vector<TracedRows>* samples) {
  const auto gather = [&](TracedRows* rows) {
    return add_lit_brdfs(built, rows) + gather_light(built, rows);
  };
  std::size_t points = 0, measured = 0, questions = 0;
  for (const TracedRows& rows : *samples) points += rows.points.size() + rows.lit.size();
  double seconds = 0;
  for (TracedRows& rows : *samples) {
    thin(points, kSamplePoints, &rows.points);
    thin(points, kSamplePoints, &rows.lit);
    const std::size_t here = rows.points.size() + rows.lit.size();
    if (!measured && here) {  // drivers compile on first use
      TracedRows warm_up = rows;
      gather(&warm_up);
    }
    const Stopwatch watch;
    questions += gather(&rows);
    seconds += watch.seconds(), measured += here;
  }
  if (!measured) return {};
  const double scale = static_cast<double>(points) / static_cast<double>(measured);
  return {static_cast<std::size_t>(scale * static_cast<double>(questions)), scale * seconds};
}

}  // namespace

Estimate estimate(const Job& job, const Plan& plan, Device& device) {
  const Stopwatch building;
  const BuiltJob built(job, plan, device);
  const double build_seconds = building.seconds();

  const int rows = std::min(kSampleRows, job.image.height);
  std::vector<TracedRows> samples;
  std::size_t queries = 0;
  const Stopwatch tracing;
  for (int n = 0; n < rows; ++n) {
    samples.push_back(built.scene().trace((2 * n + 1) * job.image.height / (2 * rows), 1));
    queries += samples.back().queries.size();
  }
  const double trace_seconds = tracing.seconds();

  const Gathered gathered = measure_gathering(built, &samples);
  std::size_t evaluated = 0;
  double device_seconds = 0;
  for (TracedRows& sample : samples) {
    thin(queries, kSampleQueries, &sample.queries);
    evaluated += sample.queries.size();
  }
  const auto evaluate = [&](const TracedRows& sample) { PendingBlock(sample, built).wait(); };
  evaluate(*std::max_element(samples.begin(), samples.end(), [](const TracedRows& a, const TracedRows& b) {
    return a.queries.size() < b.queries.size();
  }));  // warm-up: drivers compile on first use
  const double before = built.device_seconds();
  for (const TracedRows& sample : samples) evaluate(sample);
  if (evaluated)
    device_seconds = (built.device_seconds() - before) * static_cast<double>(queries) / evaluated;

  const double scale = static_cast<double>(job.image.height) / rows;
  // A CPU device takes turns with the tracing host, any other works beside it.
  const double work =
      device.info().is_cpu ? trace_seconds + device_seconds : std::max(trace_seconds, device_seconds);
  return {static_cast<std::size_t>(scale * static_cast<double>(queries + gathered.queries)),
          build_seconds + scale * (work + gathered.seconds)};
}

}  // namespace mica
