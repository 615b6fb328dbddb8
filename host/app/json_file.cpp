#include "host/app/json_file.h"

#include "host/image/image.h"
#include "mica/version.h"

namespace mica::host::app {

std::string wave_form_name(const DeviceInfo& info) {
  return std::string(word_of(default_wave_form(info)));
}

nlohmann::json describe_device(const DeviceInfo& info) {
  return {{"name", info.name},
          {"vendor", info.vendor},
          {"platform", info.platform},
          {"version", info.version},
          {"driver", info.driver},
          {"compute_units", info.compute_units},
          {"memory_bytes", info.global_bytes},
          {"largest_buffer_bytes", info.allocation_bytes},
          {"wave_form", wave_form_name(info)}};
}

void write_json(const std::string& path, const nlohmann::json& json) {
  nlohmann::json document = json;
  document["mica"] = version();
  // Paths need not be UTF-8; JSON has to be.
  write_file_atomically(path, document.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

}  // namespace mica::host::app
