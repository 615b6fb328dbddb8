#pragma once

#define CL_HPP_TARGET_OPENCL_VERSION 120
#define CL_HPP_MINIMUM_OPENCL_VERSION 120
#define CL_HPP_ENABLE_EXCEPTIONS
#include <CL/opencl.hpp>
#include <string>

#include "mica/error.h"

namespace mica::host {

/// "CL_OUT_OF_RESOURCES (the device ran out of resources)"
std::string describe_opencl_error(cl_int code);

/// "clEnqueueNDRangeKernel: CL_..." as a DeviceError; `doing` says what Mica wanted, e.g. "running
/// triangles".
DeviceError opencl_error(const cl::Error& error, const std::string& doing);

}  // namespace mica::host
