#pragma once

#include <vector>

#include "host/surface/surface.h"

namespace mica::host {

/// The surface as the pixels of an image of encoding `signed`, green up: n_x, n_y, n_z of unit length,
/// interleaved, the image's top row first (so that its bottom row is v near 0). Size: width * height * 3.
std::vector<float> to_signed_rgb(const Surface& surface);

}  // namespace mica::host
