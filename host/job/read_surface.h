#pragma once

#include <string>
#include <utility>
#include <vector>

#include "host/surface/description.h"

namespace mica::host {

/// One surface by the keys and values that a `[surface.NAME]` of a job would have. Values are TOML; what is
/// not is taken as a string. Throws UsageError with all that is wrong.
SurfaceDescription read_surface(const std::vector<std::pair<std::string, std::string>>& keys);

}  // namespace mica::host
