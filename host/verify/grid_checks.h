#pragma once

#include <vector>

#include "host/verify/device_checks.h"

namespace mica::host {

/// `grid` and the density of its draws against their definitions in double precision, for both distributions.
std::vector<Check> check_grid(Device* device);

}  // namespace mica::host
