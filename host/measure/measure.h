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
/// @param used filled with the queries of a repeat when not null.
Speed measure_speed(Evaluator* evaluator, const std::vector<Query>& queries, const Effort& effort,
                    std::vector<Query>* used = nullptr);

Errors errors_of(const std::vector<float>& densities, const std::vector<double>& references);

/// What a contender's shares are shares of.
struct Machine {
  double fma_peak = 0, bandwidth = 0;
};

/// Everything about one contender on coherent queries.
/// @param few queries that `references` answers.
Measurement measure(const Prepared& prepared, const Surface& surface, const Machine& machine,
                    double sigma_texels, const std::vector<Query>& queries, const std::vector<Query>& few,
                    const std::vector<double>& references, const Effort& effort);

/// Throws to stop; called between measurements with what comes next.
using Progress = std::function<void(const std::string& what)>;

}  // namespace mica::host::bench
