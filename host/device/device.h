#pragma once

#include <atomic>
#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "host/base/words.h"
#include "host/device/opencl.h"

namespace mica::host {

/// What a device reports of itself.
struct DeviceInfo {
  std::string name, vendor, platform, version, driver;
  bool is_cpu = false;
  unsigned compute_units = 0;
  std::size_t global_bytes = 0;      ///< memory in all
  std::size_t allocation_bytes = 0;  ///< largest single buffer
  std::size_t local_bytes = 0;       ///< local memory of a work-group
  std::size_t work_group_size = 0;   ///< largest work-group
};

struct PlatformInfo {
  std::string name, version;
};

/// Every OpenCL platform, in the loader's order; none is no error.
std::vector<PlatformInfo> list_platforms();

/// Every OpenCL device of every platform, in the loader's order; `mica devices` prints their numbers.
std::vector<DeviceInfo> list_devices();

/// How the sixteen lanes of a wave are mapped to a device; see kernels/wave/wave.h.
enum class WaveForm { vectors, items };
template <>
struct Words<WaveForm> {
  static constexpr Word<WaveForm> all[] = {{"vectors", WaveForm::vectors}, {"items", WaveForm::items}};
};
/// The form that suits a device: vectors a CPU, items all others.
WaveForm default_wave_form(const DeviceInfo& info);
constexpr std::size_t kWaveLanes = 16;

/// Bytes of a device's buffers, as they come and go.
struct BufferBytes {
  std::atomic<std::size_t> now{0}, peak{0};
};

/// An OpenCL device with its queue and its programs. Programs are built once for each (source, options), kept
/// for the life of the device, and cached on disk as binaries, keyed by source, options, device and driver.
class Device {
 public:
  /// @param index as printed by `mica devices`. Throws DeviceError when there is none.
  /// @param form of waves; default: what suits the device
  explicit Device(int index, std::optional<WaveForm> form = {});

  const DeviceInfo& info() const { return info_; }
  const cl::Context& context() const { return context_; }
  const cl::CommandQueue& queue() const { return queue_; }
  WaveForm wave_form() const { return wave_form_; }

  /// A kernel of kernels/<file>, compiled with `options` ("-DMICA_INTERPOLATION=1"). Throws DeviceError with
  /// the compiler's log. The wave form is added to the options.
  cl::Kernel kernel(const std::string& file, const std::string& name, const std::string& options);
  cl::Kernel kernel(const std::string& file, const std::string& name, const std::string& options,
                    WaveForm form);
  /// The kernel that has its file's name: "map/walk" is `walk` of kernels/map/walk.cl.
  cl::Kernel kernel(const std::string& path, const std::string& options, WaveForm form) {
    return kernel(path + ".cl", path.substr(path.rfind('/') + 1), options, form);
  }

  /// An uninitialised buffer. Throws DeviceError naming `what` when it exceeds the device's limits.
  cl::Buffer buffer(std::size_t bytes, cl_mem_flags flags, const std::string& what) const;

  /// What was compiled so far: files with their options.
  std::vector<std::string> programs() const;
  /// How many of them came from no cache.
  int compiled() const;
  /// Bytes of all buffers that there are.
  std::size_t bytes() const { return bytes_->now; }
  /// The most that all buffers together have taken at a time, since the last call of `forget_peak`.
  std::size_t peak_bytes() const { return bytes_->peak; }
  void forget_peak() { bytes_->peak = bytes_->now.load(); }

  /// A read-only buffer with a copy of `data`.
  template <typename T>
  cl::Buffer upload(const std::vector<T>& data, const std::string& what) const {
    return upload_bytes(data.data(), data.size() * sizeof(T), what);
  }

 private:
  cl::Buffer upload_bytes(const void* data, std::size_t bytes, const std::string& what) const;
  cl::Program program(const std::string& file, const std::string& options);
  cl::Program compile(const std::string& source, const std::string& flags, const std::string& what) const;

  cl::Device device_;
  DeviceInfo info_;
  WaveForm wave_form_;
  cl::Context context_;
  cl::CommandQueue queue_;
  std::shared_ptr<BufferBytes> bytes_ = std::make_shared<BufferBytes>();  // shared with the buffers
  mutable std::mutex mutex_;
  std::map<std::string, cl::Program> programs_;
  int compiled_ = 0;
};

}  // namespace mica::host
