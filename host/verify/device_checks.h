#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "host/device/device.h"

namespace mica::host {

/// One line of the selftest.
struct Check {
  std::string name;
  std::size_t points = 0;    ///< values or queries that were compared
  double worst = 0;          ///< largest error, in units of what is allowed
  std::string skipped = {};  ///< why it could not be done, or empty

  bool passed() const { return skipped.empty() && worst <= 1; }
  bool failed() const { return skipped.empty() && !(worst <= 1); }  ///< also when worst is NaN
};

/// Every size and offset of kernels/types.h on the device against the host's. `worst` is infinite when one
/// differs.
Check check_struct_layout(Device* device);

/// The special functions of kernels/wave/gaussian.h against double precision, as vectors and as work-items.
std::vector<Check> check_special_functions(Device* device);

}  // namespace mica::host
