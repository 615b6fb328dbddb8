#include "host/surface/settings.h"

#include <fmt/format.h>

#include "mica/error.h"

namespace mica::host::synthesis {

void check_setting(const char* kind, const char* setting, double value, double low, double high) {
  if (!(value >= low && value <= high)) {
    throw UsageError(fmt::format("{}: {} is {}, expected {} to {}", kind, setting, value, low, high));
  }
}

void check_resolution(const char* kind, int resolution) {
  if (resolution < 4 || resolution > 16384) {
    throw UsageError(fmt::format("{}: resolution is {}, expected 4 to 16384 texels", kind, resolution));
  }
}

}  // namespace mica::host::synthesis
