#include "host/app/about.h"

#include <fmt/format.h>

#include "host/device/device.h"
#include "mica/version.h"

namespace mica::host::app {
namespace {

std::string compiler() {
#ifdef __clang__
  return "clang++ " __clang_version__;
#else
  return "g++ " __VERSION__;
#endif
}

std::string platforms() {
  std::string text;
  try {
    for (const PlatformInfo& platform : list_platforms())
      text += fmt::format("{}{}, {}", text.empty() ? "" : "; ", platform.name, platform.version);
  } catch (const std::exception& error) {
    return error.what();
  }
  return text.empty() ? "no OpenCL platform" : text;
}

}  // namespace

std::string about() {
  return fmt::format("mica {} (commit {}, {}; {})", version(), commit(), compiler(), platforms());
}

}  // namespace mica::host::app
