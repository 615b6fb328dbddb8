#pragma once

#include "mica/error.h"

namespace mica::host {

/// What to do where there is no device. A driver that is installed may still have none: PoCL, where it cannot
/// make its cache.
DeviceError no_device();

}  // namespace mica::host
