#pragma once

#include "host/scene/viewer.h"

namespace mica::host {

/// Traces rows [first_row, first_row + row_count) of an image; see Scene.
TracedRows trace_rows(const Viewer& viewer, const PixelSettings& pixels, int width, int height, int first_row,
                      int row_count);

}  // namespace mica::host
