// mica devices: what OpenCL has to offer.
#include <fmt/format.h>

#include "host/app/commands.h"
#include "host/app/json_file.h"
#include "host/app/output.h"
#include "host/device/no_device.h"

namespace mica::host::app {
namespace {

int run(const std::string& json_path) {
  const Outputs outputs({json_path});
  const std::vector<DeviceInfo> devices = list_devices();
  if (devices.empty()) throw no_device();
  nlohmann::json list = nlohmann::json::array();
  for (std::size_t number = 0; number < devices.size(); ++number) {
    const DeviceInfo& info = devices[number];
    fmt::print("{}: {}\n", number, info.name);
    fmt::print("   platform {}, {}, driver {}\n", info.platform, info.version, info.driver);
    fmt::print("   {} compute units, {} MiB of memory, at most {} MiB in one buffer, waves as {}\n",
               info.compute_units, info.global_bytes >> 20, info.allocation_bytes >> 20,
               wave_form_name(info));
    list.push_back(describe_device(info));
  }
  if (!json_path.empty()) write_json(json_path, {{"command", "devices"}, {"devices", list}});
  return 0;
}

}  // namespace

void add_devices(CommandLine& app, Command* chosen, const MethodRegistry&) {
  auto json_path = std::make_shared<std::string>();
  CommandLine* command =
      app.add_subcommand("devices", "Lists the OpenCL devices, by the numbers that --device takes");
  command->footer(
      "\"waves as\" is how kernels use a device: as vectors (CPUs) or as neighbouring work-items (GPUs).");
  command->add_option("--json", *json_path, "Writes the list as JSON").type_name("FILE");
  command->callback([json_path, chosen] { *chosen = [json_path] { return run(*json_path); }; });
}

}  // namespace mica::host::app
