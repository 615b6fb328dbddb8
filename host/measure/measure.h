#pragma once

#include <functional>
#include <vector>

#include "host/base/query.h"
#include "host/measure/contenders.h"
#include "host/measure/results.h"

namespace mica::host::bench {

/// How much time a measurement may take.
struct Effort {
  int repeats = 11;
  double seconds_a_repeat = 0.02;  ///< batches are chosen to take about this long
};

/// Wall-clock speed of whole calls, with transfers: a warm-up, then the repeats.
/// @param queries coherent; thinned for evaluators that are too slow for all of them.
/// No queries at all where sixteen take 25 times as long as a repeat may.
Speed measure_speed(Evaluator* evaluator, const std::vector<Query>& queries, const Effort& effort);

Errors errors_of(const std::vector<float>& densities, const std::vector<double>& references);

/// What a contender's shares are shares of.
struct Machine {
  double fma_peak = 0, bandwidth = 0;
};

/// What contenders are asked on a surface.
struct Question {
  const Surface& surface;
  double sigma_texels;
  std::vector<Query> queries;      ///< coherent; those too slow for all of them are asked some
  std::vector<Query> few;          ///< for their errors
  std::vector<double> references;  ///< the answers to these
};

/// Everything about contenders on the same question. They are timed by turns, each once a round: what happens
/// on a machine meanwhile happens to all of them, and the medians of their ratios hold.
/// @param begins is called before a contender is looked at first.
std::vector<Measurement> measure_by_turns(const std::vector<Prepared>& contenders, const Question& question,
                                          const Machine& machine, const Effort& effort,
                                          const std::function<void(const Prepared&)>& begins);

/// Throws to stop; called between measurements with what comes next.
using Progress = std::function<void(const std::string& what)>;

}  // namespace mica::host::bench
