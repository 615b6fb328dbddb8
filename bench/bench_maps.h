// What the benchmarks of `pyramid` and `auto` share: maps and random queries on them.
#pragma once

#include <string>
#include <vector>

#include "host/base/query.h"
#include "host/surface/surface.h"

namespace mica::host::bench {

/// One of the 2048^2 maps "spectrum", "brushed", "flakes" and "scratches", or that of a file.
Surface make_named(const std::string& name);

/// Random footprints, each with a normal under it blurred by the roughness.
std::vector<Query> random_queries(const Surface& surface, double sigma_texels, double roughness,
                                  std::size_t count);

}  // namespace mica::host::bench
