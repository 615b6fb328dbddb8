#pragma once

#include <functional>
#include <vector>

#include "host/app/evaluation.h"
#include "host/methods/map/image_window.h"

namespace mica::host::app {

/// `draw_images` with progress and interrupts.
std::vector<float> draw_with_progress(const OpenEvaluator& open, std::size_t count,
                                      const QuerySource& footprint, const ImageWindow& window);

}  // namespace mica::host::app
