#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "mica/version.h"

namespace mica::host {
class Device;
}

MICA_BEGIN_NAMESPACE

/// What an OpenCL device reports of itself.
struct DeviceInfo {
  std::string name, vendor, platform, version, driver;
  bool is_cpu = false;
  unsigned compute_units = 0;
  std::size_t memory_bytes = 0;  ///< in all
  std::size_t buffer_bytes = 0;  ///< of the largest single buffer
};

/// Every OpenCL device of every platform, in the order in which Device counts them. Empty when there is none.
/// Throws DeviceError when a platform fails.
MICA_API std::vector<DeviceInfo> devices();

/// An open OpenCL device. Copies share it, and so does everything that is made on it: it is closed when the
/// last of them is gone.
class MICA_API Device {
 public:
  /// @param index as in devices(). Throws DeviceError when there is none.
  explicit Device(int index = 0);

  DeviceInfo info() const;
  std::size_t buffer_bytes() const;  ///< of all buffers that there are now

  /// For the library itself. Throws UsageError when this was moved from.
  const std::shared_ptr<host::Device>& implementation() const;

 private:
  std::shared_ptr<host::Device> implementation_;
};

MICA_END_NAMESPACE
