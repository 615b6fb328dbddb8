#include "mica/device.h"

#include "host/device/device.h"
#include "mica/error.h"

MICA_BEGIN_NAMESPACE
namespace {

DeviceInfo to_public(const host::DeviceInfo& info) {
  return {info.name,   info.vendor,        info.platform,     info.version,         info.driver,
          info.is_cpu, info.compute_units, info.global_bytes, info.allocation_bytes};
}

}  // namespace

std::vector<DeviceInfo> devices() {
  std::vector<DeviceInfo> infos;
  for (const host::DeviceInfo& info : host::list_devices()) infos.push_back(to_public(info));
  return infos;
}

Device::Device(int index) : implementation_(std::make_shared<host::Device>(index)) {}

DeviceInfo Device::info() const {
  return to_public(implementation()->info());
}

std::size_t Device::buffer_bytes() const {
  return implementation()->bytes();
}

const std::shared_ptr<host::Device>& Device::implementation() const {
  if (!implementation_) throw UsageError("device: found one that was moved from; expected an open one");
  return implementation_;
}

MICA_END_NAMESPACE
