#include "python/src/bindings.h"

namespace mica::python {
namespace {

std::string describe(const DeviceInfo& info) {
  return "DeviceInfo('" + info.name + "' of " + info.platform + ", " + std::to_string(info.compute_units) +
         " compute units, " + std::to_string(info.memory_bytes >> 20) + " MiB)";
}

}  // namespace

void bind_devices(nb::module_& module) {
  nb::class_<DeviceInfo>(module, "DeviceInfo", "What an OpenCL device reports of itself.")
      .def_ro("name", &DeviceInfo::name)
      .def_ro("vendor", &DeviceInfo::vendor)
      .def_ro("platform", &DeviceInfo::platform)
      .def_ro("version", &DeviceInfo::version)
      .def_ro("driver", &DeviceInfo::driver)
      .def_ro("is_cpu", &DeviceInfo::is_cpu)
      .def_ro("compute_units", &DeviceInfo::compute_units)
      .def_ro("memory_bytes", &DeviceInfo::memory_bytes)
      .def_ro("buffer_bytes", &DeviceInfo::buffer_bytes)
      .def("__repr__", &describe);
  module.def("devices", &devices, nb::call_guard<nb::gil_scoped_release>());

  nb::class_<Device>(module, "Device")
      .def(nb::init<int>(), nb::arg("index") = 0, nb::call_guard<nb::gil_scoped_release>())
      .def_prop_ro("info", &Device::info)
      .def_prop_ro("buffer_bytes", &Device::buffer_bytes);
}

}  // namespace mica::python
