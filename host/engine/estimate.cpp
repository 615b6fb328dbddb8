#include "host/engine/estimate.h"

#include <algorithm>

#include "host/base/stopwatch.h"
#include "host/engine/built_job.h"

namespace mica {
namespace {

constexpr int kSampleRows = 24;
constexpr std::size_t kSampleQueries = 8192;

/// Keeps every n-th query, so that about kSampleQueries are left of `all` in all rows.
void thin(std::size_t all, TracedRows* rows) {
  const std::size_t stride = all / kSampleQueries + 1;
  std::vector<GlintQuery> kept;
  for (std::size_t n = 0; n < rows->queries.size(); n += stride) kept.push_back(rows->queries[n]);
  rows->queries.swap(kept);
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

  std::size_t evaluated = 0;
  double device_seconds = 0;
  for (TracedRows& sample : samples) {
    thin(queries, &sample);
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
  return {static_cast<std::size_t>(scale * static_cast<double>(queries)), build_seconds + scale * work};
}

}  // namespace mica
