#pragma once

#include "host/device/device.h"

namespace mica::host::bench {

/// Memory bandwidth of the device, bytes/s: the best of a few runs of a = b + k c over arrays beyond its
/// caches (kernels/probes/triad.cl), three arrays counted.
double measure_bandwidth(Device& device);

}  // namespace mica::host::bench
