#pragma once

#include <string>

#include "host/app/command_line.h"

namespace mica::host::app {

/// `--device`: a number of `mica devices`, or "auto".
struct DeviceOption {
  std::string text;  ///< as given; empty: the environment's MICA_DEVICE, or the first device

  /// The number of the device. "auto" spreads the processes of a machine over its accelerators, and over all
  /// its devices where it has none: by SLURM_LOCALID, the process's number on its node, modulo their number.
  /// Throws UsageError for text that is neither, DeviceError for "auto" where there is no device.
  int index() const;
};

void add_device_option(CommandLine* command, DeviceOption* device);

}  // namespace mica::host::app
