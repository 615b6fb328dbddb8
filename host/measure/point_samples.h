#pragma once

#include <cstdint>
#include <vector>

#include "host/base/query.h"
#include "host/surface/surface.h"

namespace mica::host::bench {

/// D by brute force: normals at `samples` points drawn from each footprint, each blurred by the roughness,
/// averaged. What a renderer does that knows no better; unbiased, on the host with all its threads. The same
/// for any number of threads.
std::vector<float> point_samples(const Surface& surface, const std::vector<Query>& queries,
                                 std::int64_t samples, std::uint64_t seed);

}  // namespace mica::host::bench
