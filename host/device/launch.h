#pragma once

#include <string>
#include <vector>

#include "host/device/device.h"

namespace mica::host {

/// Work-items of a launch, and of each of its work-groups.
struct LaunchSize {
  std::size_t global = 1, local = 1;
};

/// What `waves` waves take. As work-items each is a work-group of its own; as vectors, where each is one
/// work-item, `waves_a_group` are one, and the number of waves is rounded up: kernels leave the rest alone.
LaunchSize launch_size(WaveForm form, std::size_t waves, std::size_t waves_a_group = 16);

/// Sets arguments from the number `first` on, in order; of a list, one argument each.
/// @return the number after the last.
template <typename Argument>
cl_uint set_argument(cl::Kernel& kernel, cl_uint first, const Argument& argument) {
  kernel.setArg(first, argument);
  return first + 1;
}
inline cl_uint set_argument(cl::Kernel& kernel, cl_uint first, const std::vector<cl::Buffer>& arguments) {
  for (const cl::Buffer& argument : arguments) kernel.setArg(first++, argument);
  return first;
}

/// Sends a kernel with all its arguments, in order.
template <typename... Arguments>
cl::Event launch(const Device& device, cl::Kernel& kernel, const LaunchSize& size,
                 const Arguments&... arguments) {
  cl_uint next = 0;
  ((next = set_argument(kernel, next, arguments)), ...);
  cl::Event done;
  device.queue().enqueueNDRangeKernel(kernel, cl::NullRange, size.global, size.local, nullptr, &done);
  return done;
}

/// How long a launch that is done has run.
double seconds_of(const cl::Event& done);

/// Does `work`; what OpenCL throws is thrown on as a DeviceError that begins with what was done: "running
/// triangles".
template <typename Work>
auto reporting(const std::string& doing, const Work& work) {
  try {
    return work();
  } catch (const cl::Error& error) {
    throw opencl_error(error, doing);
  }
}

}  // namespace mica::host
