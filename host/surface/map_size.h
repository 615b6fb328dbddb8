#pragma once

#include "host/surface/description.h"

namespace mica::host {

struct MapSize {
  int width = 0, height = 0;  ///< texels
};

/// Size of the map that `make_surface` would return, from the description or the file's header alone. Throws
/// FileError.
MapSize map_size(const SurfaceDescription& description);

}  // namespace mica::host
