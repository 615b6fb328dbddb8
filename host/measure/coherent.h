// What the benchmarks of evaluators share: the same queries, and timing that withstands a noisy machine.
#pragma once

#include <vector>

#include "host/base/query.h"
#include "host/reference/oracle.h"
#include "host/surface/surface.h"

namespace mica::host::bench {

constexpr int kBlockSide = 256;  ///< queries a side of the block of neighbouring footprints

/// 65,536 neighbouring footprints, one standard deviation apart, and a half vector that turns slowly: a
/// highlight's edge.
std::vector<Query> coherent_queries(const Surface& surface, double sigma_texels, double roughness = 0.005);

/// Every `stride`-th query: what slow evaluators are timed on.
std::vector<Query> thinned(const std::vector<Query>& queries, std::size_t stride);

struct Timing {
  double median_seconds, lowest, highest;
};
Timing timing_of(std::vector<double> seconds);

/// The relative L2 error over a thinned set.
double relative_l2(const std::vector<float>& densities,
                   const std::vector<reference::OracleResult>& references);

}  // namespace mica::host::bench
