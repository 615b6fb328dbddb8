#pragma once

#include <vector>

#include "host/measure/measure.h"
#include "host/measure/results.h"

namespace mica::host::bench {

/// Renders a crop of a snail shell with every contender and with brute force, and the reference picture with
/// the oracle. Fills in the pictures of `results`.
/// @param width pixels of the crop.
void render_pictures(int width, const std::vector<Contender>& contenders, Device& device,
                     const Progress& progress, Results* results);

}  // namespace mica::host::bench
