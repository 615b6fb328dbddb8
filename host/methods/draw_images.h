#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "host/methods/evaluator.h"

namespace mica::host {

/// Images of `count` footprints' P-NDFs, one after the other, 0 off the disk: by the evaluator's own painter
/// where it has one, and query by query where not, for which it is calibrated.
/// @param footprint its half vector does not matter.
/// @param between called between pieces of work with the images done; may throw to stop.
std::vector<float> draw_images(Evaluator& evaluator, std::size_t count, const QuerySource& footprint,
                               const ImageWindow& window,
                               const std::function<void(std::size_t done)>& between);

}  // namespace mica::host
