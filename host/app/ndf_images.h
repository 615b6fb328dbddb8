#pragma once

#include <functional>
#include <vector>

#include "host/app/evaluation.h"
#include "host/methods/map/image_window.h"

namespace mica::host::app {

/// Images of `count` footprints' P-NDFs, one after the other, 0 off the disk: element by element where the
/// evaluator can, and query by query where not.
/// @param footprint its half vector does not matter.
std::vector<float> draw_images(const OpenEvaluator& open, std::size_t count,
                               const std::function<Query(std::size_t)>& footprint, const ImageWindow& window);

}  // namespace mica::host::app
