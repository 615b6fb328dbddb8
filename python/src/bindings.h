#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <string>
#include <utility>
#include <vector>

#include "mica/mica.h"

namespace mica::python {

namespace nb = nanobind;

/// float32 or float64, any strides.
using Array = nb::ndarray<nb::ro, nb::device::cpu>;
/// What answers are written to.
using Room = nb::ndarray<float, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

/// Settings in words, as of a job file.
using SettingTexts = std::vector<std::pair<std::string, std::string>>;
Settings to_settings(const SettingTexts& texts);

/// A file's name or an argument, whose bytes need not be text.
inline std::string to_text(const nb::bytes& bytes) {
  return {bytes.c_str(), bytes.size()};
}

inline Span<float> to_span(const Room& room) {
  return {room.data(), room.size()};
}

/// @param report called with the GIL held, or None. It has to outlive the control.
RunControl to_control(const CancellationToken& cancellation, nb::handle report);

/// Work that takes a while, without the GIL.
template <typename Work>
auto without_gil(const Work& work) {
  const nb::gil_scoped_release release;
  return work();
}

void bind_errors(nb::module_& module);
void bind_devices(nb::module_& module);
void bind_maps(nb::module_& module);
void bind_evaluators(nb::module_& module);
void bind_brdfs(nb::module_& module);
void bind_jobs(nb::module_& module);
void bind_glints(nb::module_& module);
void bind_methods(nb::module_& module);

}  // namespace mica::python
