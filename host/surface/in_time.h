#pragma once

#include "host/surface/description.h"

namespace mica::host {

/// Whether a surface changes from frame to frame.
bool moves(const SurfaceDescription& surface);

/// The surface some seconds after frame 0.
SurfaceDescription after(SurfaceDescription surface, double seconds);

}  // namespace mica::host
