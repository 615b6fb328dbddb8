#include "host/device/opencl.h"

#include <fmt/format.h>

#include <algorithm>

namespace mica::host {
namespace {

struct ErrorName {
  cl_int code;
  const char* name;
  const char* meaning;
};

constexpr ErrorName kErrorNames[] = {
    {CL_DEVICE_NOT_FOUND, "CL_DEVICE_NOT_FOUND", "there is no such device"},
    {CL_DEVICE_NOT_AVAILABLE, "CL_DEVICE_NOT_AVAILABLE", "the device is in use or switched off"},
    {CL_COMPILER_NOT_AVAILABLE, "CL_COMPILER_NOT_AVAILABLE", "the driver has no kernel compiler"},
    {CL_MEM_OBJECT_ALLOCATION_FAILURE, "CL_MEM_OBJECT_ALLOCATION_FAILURE",
     "the device's memory does not suffice"},
    {CL_OUT_OF_RESOURCES, "CL_OUT_OF_RESOURCES", "the device ran out of resources"},
    {CL_OUT_OF_HOST_MEMORY, "CL_OUT_OF_HOST_MEMORY", "the host's memory does not suffice"},
    {CL_BUILD_PROGRAM_FAILURE, "CL_BUILD_PROGRAM_FAILURE", "the kernel does not compile"},
    {CL_INVALID_VALUE, "CL_INVALID_VALUE", "an argument is not valid"},
    {CL_INVALID_DEVICE, "CL_INVALID_DEVICE", "the device is not valid"},
    {CL_INVALID_BUFFER_SIZE, "CL_INVALID_BUFFER_SIZE",
     "the buffer is empty or larger than the device allows"},
    {CL_INVALID_KERNEL_NAME, "CL_INVALID_KERNEL_NAME", "the program has no kernel of this name"},
    {CL_INVALID_KERNEL_ARGS, "CL_INVALID_KERNEL_ARGS", "a kernel argument is not set"},
    {CL_INVALID_ARG_SIZE, "CL_INVALID_ARG_SIZE",
     "a kernel argument has another size than the kernel declares"},
    {CL_INVALID_WORK_GROUP_SIZE, "CL_INVALID_WORK_GROUP_SIZE", "the work-group does not fit the device"},
    {CL_PLATFORM_NOT_FOUND_KHR, "CL_PLATFORM_NOT_FOUND_KHR", "no OpenCL platform is installed"},
};

}  // namespace

std::string describe_opencl_error(cl_int code) {
  const auto* found = std::find_if(std::begin(kErrorNames), std::end(kErrorNames),
                                   [code](const ErrorName& entry) { return entry.code == code; });
  if (found == std::end(kErrorNames)) return fmt::format("OpenCL error {}", code);
  return fmt::format("{} ({})", found->name, found->meaning);
}

DeviceError opencl_error(const cl::Error& error, const std::string& doing) {
  return DeviceError(fmt::format("{}: {}: {}", doing, error.what(), describe_opencl_error(error.err())));
}

}  // namespace mica::host
