#include "host/app/device_option.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <numeric>
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

/// What is asked for, and where.
struct Wanted {
  std::string text, source;

  [[noreturn]] void refuse(const std::string& expected) const {
    throw UsageError(fmt::format("{}{}: expected {}", source, text, expected));
  }
};

Wanted wanted_by(const DeviceOption& option) {
  if (!option.text.empty()) return {option.text, "--device "};
  return {variable("MICA_DEVICE"), "MICA_DEVICE="};
}

std::vector<int> numbers_of_all() {
  std::vector<int> all(list_devices().size());
  if (all.empty()) throw no_device();
  std::iota(all.begin(), all.end(), 0);
  return all;
}

bool is_several(const Wanted& wanted) {
  return wanted.text == "all" || wanted.text.find(',') != std::string::npos;
}

}  // namespace

int DeviceOption::index() const {
  const Wanted wanted = wanted_by(*this);
  if (wanted.text.empty()) return 0;
  if (wanted.text == "auto") return device_of_this_process();
  if (is_several(wanted))
    wanted.refuse("one device: `mica render` and `mica eval` of a P-NDF share their work among several");
  if (const std::optional<int> number = whole_number(wanted.text)) return *number;
  wanted.refuse("a number that `mica devices` lists, or auto");
}

std::vector<int> DeviceOption::indices() const {
  const Wanted wanted = wanted_by(*this);
  if (!is_several(wanted)) return {index()};
  if (wanted.text == "all") return numbers_of_all();
  std::vector<int> numbers;
  for (std::size_t first = 0; first <= wanted.text.size();) {
    const std::size_t end = std::min(wanted.text.find(',', first), wanted.text.size());
    const std::optional<int> number = whole_number(wanted.text.substr(first, end - first));
    if (!number || std::count(numbers.begin(), numbers.end(), *number) > 0)
      wanted.refuse("numbers that `mica devices` lists, each once, or all");
    numbers.push_back(*number);
    first = end + 1;
  }
  return numbers;
}

void add_device_option(CommandLine* command, DeviceOption* device) {
  command
      ->add_option(
          "--device", device->text,
          "OpenCL device, by its number in `mica devices`; auto: by the process's number on its node; "
          "default MICA_DEVICE, or 0")
      .type_name("N");
}

void add_devices_option(CommandLine* command, DeviceOption* device, const std::string& what) {
  command
      ->add_option("--device", device->text,
                   fmt::format("OpenCL device, by its number in `mica devices`; several with commas, or all: "
                               "they share {}; auto: one, by the process's number on its node; default "
                               "MICA_DEVICE, or 0",
                               what))
      .type_name("N");
}

}  // namespace mica::host::app
