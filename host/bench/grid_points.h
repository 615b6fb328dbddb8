#pragma once

#include <vector>

#include "host/bench/measure.h"
#include "host/bench/results.h"

namespace mica::bench {

/// Cost of `grid` against the footprint, and its error against [Kem25] Algorithm 1 in double precision.
std::vector<GridPoint> measure_grid(Device& device, const Effort& effort, const Progress& progress);

}  // namespace mica::bench
