#pragma once

#include <vector>

#include "host/measure/measure.h"
#include "host/measure/results.h"

namespace mica::host::bench {

/// Cost of `grid` against the footprint, and its error against [Kem25] Algorithm 1 in double precision.
std::vector<GridPoint> measure_grid(Device& device, const Effort& effort, const Progress& progress);

}  // namespace mica::host::bench
