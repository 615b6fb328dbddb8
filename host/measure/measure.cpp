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

/// The lesser of two: a batch that was chosen for a pause of the machine would be too small.
double least_seconds_for(Evaluator* evaluator, const std::vector<Query>& queries) {
  const double first = seconds_for(evaluator, queries);
  return std::min(first, seconds_for(evaluator, queries));
}

/// Part of the queries that takes about as long as a repeat may; empty when the least takes far longer.
std::vector<Query> affordable(Evaluator* evaluator, const std::vector<Query>& queries, double seconds) {
  constexpr double far_longer = 25;
  std::size_t stride = std::max<std::size_t>(queries.size() / kLeastQueries, 1);
  std::vector<Query> sample = thinned(queries, stride);
  evaluator->evaluate(sample);  // drivers compile on first use
  double taken = least_seconds_for(evaluator, sample);
  if (taken > far_longer * seconds) return {};
  while (stride > 1 && taken < 0.3 * seconds) {
    stride = std::max<std::size_t>(stride / 4, 1);
    sample = thinned(queries, stride);
    taken = least_seconds_for(evaluator, sample);
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

Speed speed_of(std::size_t queries, const std::vector<double>& seconds) {
  const Timing timing = timing_of(seconds);
  const double count = static_cast<double>(queries);
  return {count / timing.median_seconds, count / timing.highest, count / timing.lowest, queries,
          static_cast<int>(seconds.size())};
}

}  // namespace

Speed measure_speed(Evaluator* evaluator, const std::vector<Query>& queries, const Effort& effort) {
  const std::vector<Query> batch = affordable(evaluator, queries, effort.seconds_a_repeat);
  if (batch.empty()) return {};
  std::vector<double> seconds;
  for (int repeat = 0; repeat < effort.repeats; ++repeat) seconds.push_back(seconds_for(evaluator, batch));
  return speed_of(batch.size(), seconds);
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

namespace {

/// A contender and what it is timed on; no batch: it is not.
struct Turn {
  const Prepared* prepared;
  Measurement measurement;
  std::vector<Query> batch;
  std::vector<double> seconds;  ///< of each round
};

/// Median over rounds of how much faster a turn is than another.
double over(const Turn& turn, const Turn& other) {
  std::vector<double> ratios;
  const double queries = static_cast<double>(turn.batch.size()) / static_cast<double>(other.batch.size());
  for (std::size_t round = 0; round < turn.seconds.size(); ++round)
    ratios.push_back(queries * other.seconds[round] / turn.seconds[round]);
  return timing_of(ratios).median_seconds;
}

Turn turn_of(const Prepared& prepared, const std::vector<Query>& queries, const Effort& effort) {
  Turn turn{&prepared, {}, {}, {}};
  Measurement& m = turn.measurement;
  m.evaluator = prepared.contender.evaluator, m.label = prepared.contender.label,
  m.knob = prepared.contender.knob;
  m.tolerance = prepared.contender.settings->tolerance.value_or(0);
  m.refused = prepared.refused;
  if (!prepared.evaluator) return turn;
  turn.batch = affordable(prepared.evaluator.get(), queries, effort.seconds_a_repeat);
  if (turn.batch.empty()) m.refused = "too slow to be measured here";
  return turn;
}

}  // namespace

std::vector<Measurement> measure_by_turns(const std::vector<Prepared>& contenders, const Question& question,
                                          const Machine& machine, const Effort& effort,
                                          const std::function<void(const Prepared&)>& begins) {
  std::vector<Turn> turns;
  for (const Prepared& prepared : contenders) {
    begins(prepared);
    turns.push_back(turn_of(prepared, question.queries, effort));
  }
  for (int round = 0; round < effort.repeats; ++round)
    for (Turn& turn : turns)
      if (!turn.batch.empty())
        turn.seconds.push_back(seconds_for(turn.prepared->evaluator.get(), turn.batch));
  const Turn* first = nullptr;
  std::vector<Measurement> measurements;
  for (const Turn& turn : turns) {
    Measurement m = turn.measurement;
    if (!turn.batch.empty()) {
      if (!first) first = &turn;
      Evaluator& evaluator = *turn.prepared->evaluator;
      m.speed = speed_of(turn.batch.size(), turn.seconds);
      m.over_first = over(turn, *first);
      m.errors = errors_of(evaluator.evaluate(question.few), question.references);
      m.build_seconds = evaluator.build_seconds();  // now: some build what a footprint needs when it comes
      m.device_bytes = evaluator.device_bytes();
      m.share_of_peak = share_of_peak(*turn.prepared, machine.fma_peak, turn.batch, m.speed.median);
      m.share_of_bandwidth =
          share_of_bandwidth(m, question.surface, question.sigma_texels, machine.bandwidth);
    }
    measurements.push_back(std::move(m));
  }
  return measurements;
}

}  // namespace mica::host::bench
