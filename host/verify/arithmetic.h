#pragma once

#include <string>
#include <vector>

#include "host/device/device.h"
#include "host/verify/device_checks.h"

namespace mica::host {

/// The largest error of one function on a device, in units of the last place (ULP) of the exact value.
struct FunctionError {
  std::string function, range;
  std::size_t points = 0;
  double worst_ulp = 0;   ///< infinite when an answer is not a number
  double worst_at = 0;    ///< the argument (of atan2: the angle)
  double opencl_ulp = 0;  ///< what OpenCL 1.2 allows; 0: not one of its functions
  double needed_ulp = 0;  ///< what the kernels' promised errors bear; 0: no kernel uses it
};

/// Every function in the device's wave form, over ranges that are dense in the numbers' bits.
std::vector<FunctionError> measure_arithmetic(Device* device);

/// "good enough" when each function that kernels use has the digits that they need.
std::vector<Check> arithmetic_checks(const std::vector<FunctionError>& errors);

}  // namespace mica::host
