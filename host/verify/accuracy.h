#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "host/base/query.h"
#include "host/methods/evaluator.h"
#include "host/methods/standard.h"
#include "host/reference/oracle.h"
#include "host/surface/surface.h"

namespace mica::host {

/// Queries of one footprint, by turns on the normals under it, near them (1 to 4 roughnesses away), where
/// densities fall off (4 to 6), and anywhere on the disk. The first one is on the normal at the mean.
std::vector<Query> probe(const Surface& surface, const Footprint& footprint, double roughness,
                         int half_vectors, std::uint64_t seed);

/// How far an evaluator lies from its reference, in units of what it promises.
struct Accuracy {
  std::size_t queries = 0;
  double worst = 0;  ///< largest |D - ref| / promised error; above 1 the promise is broken
  Query worst_query;
  double worst_density = 0, worst_reference = 0;

  void add(const Accuracy& other);
};

/// Evaluates probes with both. A peak can be far from the few half vectors of a probe, where the surface
/// folds normals onto each other: each probe gets one more query, the brightest of 64 normals under the
/// footprint as the evaluator sees them.
/// @param probes each of one footprint. Throws what the two throw.
Accuracy compare(Evaluator* evaluator, const reference::Oracle& oracle, const Surface& surface,
                 std::vector<std::vector<Query>> probes);

/// Compares with a method's own definition, by what it promises to that.
Accuracy compare(Evaluator* evaluator, const Standard& standard, const Surface& surface,
                 std::vector<std::vector<Query>> probes);
/// Compares without a brightest query, which needs a map.
Accuracy compare_probes(Evaluator* evaluator, const Standard& standard,
                        const std::vector<std::vector<Query>>& probes);

/// Compares with another reference, by what is promised against it at a roughness.
using References = std::function<std::vector<double>(const std::vector<Query>&)>;
Accuracy compare(Evaluator* evaluator, const References& references,
                 const std::function<Promise(double roughness)>& promise, const Surface& surface,
                 std::vector<std::vector<Query>> probes);

}  // namespace mica::host
