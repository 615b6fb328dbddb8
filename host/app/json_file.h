#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "host/device/device.h"

namespace mica::host::app {

/// What a device reports of itself.
nlohmann::json describe_device(const DeviceInfo& info);

/// "vectors" or "items": how kernels spread a wave's lanes on such a device; see kernels/wave/wave.h.
std::string wave_form_name(const DeviceInfo& info);

/// Writes whole or not at all, with the program's name and version in front. Throws FileError.
void write_json(const std::string& path, const nlohmann::json& json);

}  // namespace mica::host::app
