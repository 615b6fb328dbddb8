#include "host/measure/measure.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "host/base/error_norms.h"
#include "host/base/stopwatch.h"
#include "host/measure/coherent.h"

namespace mica::host::bench {
namespace {

constexpr std::size_t kLeastQueries = 16;

double seconds_for(Evaluator* evaluator, const std::vector<Query>& queries) {
  const Stopwatch watch;
  evaluator->evaluate(queries);
  return watch.seconds();
}

/// Part of the queries that takes about as long as a repeat may; empty when the least takes far longer.
std::vector<Query> affordable(Evaluator* evaluator, const std::vector<Query>& queries, double seconds) {
  constexpr double far_longer = 25;
  std::size_t stride = std::max<std::size_t>(queries.size() / kLeastQueries, 1);
  std::vector<Query> sample = thinned(queries, stride);
  evaluator->evaluate(sample);  // drivers compile on first use
  double taken = seconds_for(evaluator, sample);
  if (taken > far_longer * seconds) return {};
  while (stride > 1 && taken < 0.3 * seconds) {
    stride = std::max<std::size_t>(stride / 4, 1);
    sample = thinned(queries, stride);
    taken = seconds_for(evaluator, sample);
  }
  return sample;
}

double share_of_peak(const Prepared& prepared, double fma_peak, const std::vector<Query>& queries,
                     double rate) {
  if (!prepared.counter) return -1;
  const std::vector<float> counts = prepared.counter->evaluate(queries);
  const double counts_a_query =
      std::accumulate(counts.begin(), counts.end(), 0.0) / static_cast<double>(counts.size());
  return rate * counts_a_query * prepared.flops_a_count / fma_peak;
}

/// The least that has to be moved: queries in, densities out, and once each part of the structure that lies
/// under a footprint of the block.
double share_of_bandwidth(const Measurement& m, const Surface& surface, double sigma_texels,
                          double bandwidth) {
  constexpr double bytes_a_query = 64 + 4, reach = 5;
  const double side = (std::sqrt(65536.0) + 2 * reach) * sigma_texels;
  const double covered = std::min(1.0, side * side / (1.0 * surface.width() * surface.height()));
  const double queries = static_cast<double>(m.speed.queries);
  const double bytes = queries * bytes_a_query + covered * static_cast<double>(m.device_bytes);
  return bytes * m.speed.median / queries / bandwidth;
}

}  // namespace

Speed measure_speed(Evaluator* evaluator, const std::vector<Query>& queries, const Effort& effort,
                    std::vector<Query>* used) {
  const std::vector<Query> batch = affordable(evaluator, queries, effort.seconds_a_repeat);
  if (batch.empty()) return {};
  std::vector<double> seconds;
  for (int repeat = 0; repeat < effort.repeats; ++repeat) seconds.push_back(seconds_for(evaluator, batch));
  const Timing timing = timing_of(seconds);
  const double count = static_cast<double>(batch.size());
  if (used) *used = batch;
  return {count / timing.median_seconds, count / timing.highest, count / timing.lowest, batch.size(),
          effort.repeats};
}

Errors errors_of(const std::vector<float>& densities, const std::vector<double>& references) {
  const double peak = *std::max_element(references.begin(), references.end());
  RelativeL2 l2;
  std::vector<double> errors;
  for (std::size_t n = 0; n < references.size(); ++n) {
    const double difference = std::abs(densities[n] - references[n]);
    l2.add(densities[n], references[n]);
    errors.push_back(difference == 0 ? 0 : difference / (references[n] + 0.01 * peak));
  }
  std::sort(errors.begin(), errors.end());
  Errors result;
  result.relative_l2 = l2.has_reference() ? l2.value() : 0;
  result.percentile_99 = errors[static_cast<std::size_t>(0.99 * static_cast<double>(errors.size() - 1))];
  result.maximum = errors.back();
  return result;
}

Measurement measure(const Prepared& prepared, const Surface& surface, const Machine& machine,
                    double sigma_texels, const std::vector<Query>& queries, const std::vector<Query>& few,
                    const std::vector<double>& references, const Effort& effort) {
  Measurement m;
  m.evaluator = prepared.contender.evaluator, m.label = prepared.contender.label,
  m.knob = prepared.contender.knob;
  m.tolerance = prepared.contender.settings->tolerance.value_or(0);
  m.refused = prepared.refused;
  if (!prepared.evaluator) return m;
  Evaluator& evaluator = *prepared.evaluator;
  std::vector<Query> batch;
  m.speed = measure_speed(&evaluator, queries, effort, &batch);
  if (m.speed.queries == 0) {
    m.refused = "too slow to be measured here";
    return m;
  }
  m.errors = errors_of(evaluator.evaluate(few), references);
  m.build_seconds = evaluator.build_seconds();  // now: some build what a footprint needs when it comes
  m.device_bytes = evaluator.device_bytes();
  m.share_of_peak = share_of_peak(prepared, machine.fma_peak, batch, m.speed.median);
  m.share_of_bandwidth = share_of_bandwidth(m, surface, sigma_texels, machine.bandwidth);
  return m;
}

}  // namespace mica::host::bench
