#include "host/app/device_option.h"

#include <fmt/format.h>

#include <charconv>
#include <cstdlib>
#include <optional>
#include <vector>

#include "host/device/device.h"
#include "host/device/no_device.h"
#include "mica/error.h"

namespace mica::host::app {
namespace {

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

std::optional<int> whole_number(const std::string& text) {
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || number < 0) return std::nullopt;
  return number;
}

int device_of_this_process() {
  const std::string rank = variable("SLURM_LOCALID");
  const std::optional<int> number = rank.empty() ? 0 : whole_number(rank);
  if (!number) throw UsageError(fmt::format("SLURM_LOCALID={}: expected a whole number from 0", rank));
  const std::vector<DeviceInfo> devices = list_devices();
  std::vector<int> all, accelerators;
  for (const DeviceInfo& device : devices) {
    const int index = static_cast<int>(all.size());
    all.push_back(index);
    if (!device.is_cpu) accelerators.push_back(index);
  }
  const std::vector<int>& candidates = accelerators.empty() ? all : accelerators;
  if (candidates.empty()) throw no_device();
  return candidates[static_cast<std::size_t>(*number) % candidates.size()];
}

}  // namespace

int DeviceOption::index() const {
  const std::string of_environment = text.empty() ? variable("MICA_DEVICE") : "";
  const std::string& wanted = text.empty() ? of_environment : text;
  if (wanted.empty()) return 0;
  if (wanted == "auto") return device_of_this_process();
  if (const std::optional<int> number = whole_number(wanted)) return *number;
  throw UsageError(fmt::format("{}{}: expected a number that `mica devices` lists, or auto",
                               text.empty() ? "MICA_DEVICE=" : "--device ", wanted));
}

void add_device_option(CommandLine* command, DeviceOption* device) {
  command
      ->add_option(
          "--device", device->text,
          "OpenCL device, by its number in `mica devices`; auto: by the process's number on its node; "
          "default MICA_DEVICE, or 0")
      .type_name("N");
}

}  // namespace mica::host::app
