#pragma once

#include <vector>

#include "host/verify/device_checks.h"

namespace mica::host {

/// `pyramid` against the oracle, query by query and image by image. It approximates the map: what is allowed
/// is a relative L2 of 1%.
std::vector<Check> check_pyramid(Device* device);

}  // namespace mica::host
