#include "host/device/device.h"

#include <fmt/format.h>

#include "host/device/binary_cache.h"
#include "host/device/kernel_sources.h"
#include "host/device/no_device.h"

namespace mica::host {
namespace {

std::vector<cl::Platform> all_platforms() {
  std::vector<cl::Platform> platforms;
  try {
    cl::Platform::get(&platforms);
  } catch (const cl::Error& error) {
    if (error.err() != CL_PLATFORM_NOT_FOUND_KHR) throw opencl_error(error, "listing OpenCL platforms");
  }
  return platforms;
}

std::vector<cl::Device> all_devices() {
  std::vector<cl::Device> devices;
  for (const cl::Platform& platform : all_platforms()) {
    std::vector<cl::Device> found;
    try {
      platform.getDevices(CL_DEVICE_TYPE_ALL, &found);
    } catch (const cl::Error& error) {
      if (error.err() != CL_DEVICE_NOT_FOUND) throw opencl_error(error, "listing OpenCL devices");
    }
    devices.insert(devices.end(), found.begin(), found.end());
  }
  return devices;
}

DeviceInfo describe(const cl::Device& device) {
  DeviceInfo info;
  info.name = device.getInfo<CL_DEVICE_NAME>();
  info.vendor = device.getInfo<CL_DEVICE_VENDOR>();
  info.platform = cl::Platform(device.getInfo<CL_DEVICE_PLATFORM>()).getInfo<CL_PLATFORM_NAME>();
  info.version = device.getInfo<CL_DEVICE_VERSION>();
  info.driver = device.getInfo<CL_DRIVER_VERSION>();
  info.is_cpu = (device.getInfo<CL_DEVICE_TYPE>() & CL_DEVICE_TYPE_CPU) != 0;
  info.compute_units = device.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>();
  info.global_bytes = device.getInfo<CL_DEVICE_GLOBAL_MEM_SIZE>();
  info.allocation_bytes = device.getInfo<CL_DEVICE_MAX_MEM_ALLOC_SIZE>();
  info.local_bytes = device.getInfo<CL_DEVICE_LOCAL_MEM_SIZE>();
  info.work_group_size = device.getInfo<CL_DEVICE_MAX_WORK_GROUP_SIZE>();
  return info;
}

}  // namespace

DeviceError no_device() {
  const std::string none = "no OpenCL device found; ";
  for (const cl::Platform& platform : all_platforms())
    return DeviceError(
        fmt::format("{}the platform {} is installed but offers none: if it is PoCL, set POCL_CACHE_DIR to a "
                    "folder that can be "
                    "written (POCL_DEBUG=error says more)",
                    none, platform.getInfo<CL_PLATFORM_NAME>()));
  return DeviceError(none + "on Debian `apt install pocl-opencl-icd` adds the CPU as one");
}

namespace {

cl::Device choose(int index) {
  const std::vector<cl::Device> devices = all_devices();
  if (devices.empty()) throw no_device();
  if (index < 0 || index >= static_cast<int>(devices.size()))
    throw DeviceError(
        fmt::format("there is no OpenCL device {}; `mica devices` lists 0 to {}", index, devices.size() - 1));
  return devices[index];
}

}  // namespace

std::vector<PlatformInfo> list_platforms() {
  std::vector<PlatformInfo> infos;
  for (const cl::Platform& platform : all_platforms())
    infos.push_back({platform.getInfo<CL_PLATFORM_NAME>(), platform.getInfo<CL_PLATFORM_VERSION>()});
  return infos;
}

std::vector<DeviceInfo> list_devices() {
  std::vector<DeviceInfo> infos;
  for (const cl::Device& device : all_devices()) infos.push_back(describe(device));
  return infos;
}

WaveForm default_wave_form(const DeviceInfo& info) {
  return info.is_cpu ? WaveForm::vectors : WaveForm::items;
}

Device::Device(int index, std::optional<WaveForm> form)
    : device_(choose(index)), info_(describe(device_)), wave_form_(form.value_or(default_wave_form(info_))) {
  try {
    context_ = cl::Context(device_);
    queue_ = cl::CommandQueue(context_, device_, CL_QUEUE_PROFILING_ENABLE);
  } catch (const cl::Error& error) {
    throw opencl_error(error, "opening OpenCL device " + info_.name);
  }
}

cl::Program Device::compile(const std::string& source, const std::string& flags,
                            const std::string& what) const {
  cl::Program program(context_, source);
  try {
    program.build({device_}, flags.c_str());
  } catch (const cl::Error& error) {
    throw DeviceError(fmt::format("{}\n{}", opencl_error(error, "building " + what).what(),
                                  program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(device_)));
  }
  return program;
}

cl::Program Device::program(const std::string& file, const std::string& options) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = programs_.find(file + " " + options);
  if (found != programs_.end()) return found->second;

  const std::string source = expand_kernel_source(file);
  const std::string flags = options + " -w";  // warnings are of the lint, not of whoever renders
  const BinaryCache cache(info_, source, flags);
  cl::Program program;
  if (!cache.load(context_, device_, &program)) {
    const BinaryCache::Turn turn = cache.wait_for_turn();
    if (!cache.load(context_, device_, &program)) {
      program = compile(source, flags, file + " " + options);
      cache.store(program);
      ++compiled_;
    }
  }
  return programs_.emplace(file + " " + options, program).first->second;
}

cl::Kernel Device::kernel(const std::string& file, const std::string& name, const std::string& options) {
  return kernel(file, name, options, wave_form());
}

cl::Kernel Device::kernel(const std::string& file, const std::string& name, const std::string& options,
                          WaveForm form) {
  const std::string wave = form == WaveForm::items ? " -DMICA_WAVE_ITEMS=1" : " -DMICA_WAVE_ITEMS=0";
  try {
    return cl::Kernel(program(file, "-cl-std=CL1.2 " + options + wave), name.c_str());
  } catch (const cl::Error& error) {
    throw opencl_error(error, fmt::format("creating kernel {} of {}", name, file));
  }
}

int Device::compiled() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return compiled_;
}

std::vector<std::string> Device::programs() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::vector<std::string> names;
  for (const auto& [name, program] : programs_) names.push_back(name);
  return names;
}

namespace {

/// A buffer's share of its device's bytes, which ends when OpenCL destroys the buffer.
struct CountedBytes {
  std::shared_ptr<BufferBytes> bytes;
  std::size_t count;
};
void CL_CALLBACK stop_counting(cl_mem, void* counted) {
  const std::unique_ptr<CountedBytes> own(static_cast<CountedBytes*>(counted));
  own->bytes->now -= own->count;
}

void count_bytes(const std::shared_ptr<BufferBytes>& bytes, std::size_t count, cl::Buffer* buffer) {
  auto counted = std::make_unique<CountedBytes>(CountedBytes{bytes, count});
  buffer->setDestructorCallback(stop_counting, counted.get());
  counted.release();  // the callback's
  const std::size_t now = bytes->now += count;
  for (std::size_t peak = bytes->peak; now > peak && !bytes->peak.compare_exchange_weak(peak, now);) {
  }
}

}  // namespace

cl::Buffer Device::buffer(std::size_t bytes, cl_mem_flags flags, const std::string& what) const {
  if (bytes > info_.allocation_bytes)
    throw DeviceError(fmt::format("{} takes {} MiB in one buffer, but {} allows {} MiB", what, bytes >> 20,
                                  info_.name, info_.allocation_bytes >> 20));
  try {
    cl::Buffer buffer(context_, flags, std::max<std::size_t>(bytes, 1));
    count_bytes(bytes_, bytes, &buffer);
    return buffer;
  } catch (const cl::Error& error) {
    throw opencl_error(error, fmt::format("allocating {} ({} bytes)", what, bytes));
  }
}

cl::Buffer Device::upload_bytes(const void* data, std::size_t bytes, const std::string& what) const {
  const cl::Buffer result = buffer(bytes, CL_MEM_READ_ONLY, what);
  try {
    if (bytes) queue_.enqueueWriteBuffer(result, CL_TRUE, 0, bytes, data);
  } catch (const cl::Error& error) {
    throw opencl_error(error, "uploading " + what);
  }
  return result;
}

}  // namespace mica::host
