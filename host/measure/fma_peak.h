#pragma once

#include "host/device/device.h"

namespace mica::host::bench {

/// Multiply-add peak of the device, FLOP/s: the best of a few runs of kernels/probes/fma_peak.cl.
double measure_fma_peak(Device& device);

}  // namespace mica::host::bench
