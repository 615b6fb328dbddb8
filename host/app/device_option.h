#pragma once

#include <string>
#include <vector>

#include "host/app/command_line.h"

namespace mica::host::app {

/// `--device`: a number of `mica devices`, or "auto"; of commands that share their work, several numbers with
/// commas between them, or "all".
struct DeviceOption {
  std::string text;  ///< as given; empty: the environment's MICA_DEVICE, or the first device

  /// The number of the device. "auto" spreads the processes of a machine over its accelerators, and over all
  /// its devices where it has none: by SLURM_LOCALID, the process's number on its node, modulo their number.
  /// Throws UsageError for text that is neither, DeviceError for "auto" where there is no device.
  int index() const;

  /// The numbers of all devices that are given, each once; as `index` where that is one. Throws as `index`,
  /// which takes no more than one.
  std::vector<int> indices() const;
};

void add_device_option(CommandLine* command, DeviceOption* device);
/// Of a command that shares its work among several. @param what is shared: "densities".
void add_devices_option(CommandLine* command, DeviceOption* device, const std::string& what);

}  // namespace mica::host::app
