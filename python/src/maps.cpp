#include "python/src/bindings.h"

namespace mica::python {
namespace {

/// @param normals (height, width, 2 or 3), C-contiguous, row 0 at v near 0.
NormalMap map_of(const Array& normals, int interpolation) {
  if (normals.ndim() != 3)
    throw UsageError("normals: found an array of " + std::to_string(normals.ndim()) +
                     " dimensions; expected (height, width, 2 or 3)");
  const auto height = static_cast<int>(normals.shape(0)), width = static_cast<int>(normals.shape(1));
  const auto channels = static_cast<int>(normals.shape(2));
  const auto kind = static_cast<Interpolation>(interpolation);
  return without_gil([&] {
    if (normals.dtype() == nb::dtype<double>())
      return NormalMap::from_normals(
          width, height, Span<const double>(static_cast<const double*>(normals.data()), normals.size()),
          channels, kind);
    return NormalMap::from_normals(
        width, height, Span<const float>(static_cast<const float*>(normals.data()), normals.size()), channels,
        kind);
  });
}

/// The map's own memory, which lives as long as the array.
nb::ndarray<nb::numpy, const double, nb::ndim<3>> normals_of(nb::handle_t<NormalMap> self) {
  const auto& map = nb::cast<const NormalMap&>(self);
  const auto height = static_cast<std::size_t>(map.height()), width = static_cast<std::size_t>(map.width());
  return {map.normals().data, {height, width, 2}, self};
}

}  // namespace

void bind_maps(nb::module_& module) {
  nb::class_<NormalMap>(module, "NormalMap")
      .def_static(
          "load",
          [](const nb::bytes& path, const SettingTexts& settings) {
            const std::string name = to_text(path);
            return without_gil([&] { return NormalMap::load(name, to_settings(settings)); });
          },
          nb::arg("path"), nb::arg("settings"))
      .def_static(
          "generate",
          [](const std::string& kind, const SettingTexts& settings) {
            return without_gil([&] { return NormalMap::generate(kind, to_settings(settings)); });
          },
          nb::arg("kind"), nb::arg("settings"))
      .def_static(
          "from_normals", &map_of, nb::arg("normals"), nb::arg("interpolation"),
          nb::sig(
              "def from_normals(normals: numpy.typing.NDArray[typing.Any], interpolation: int) -> NormalMap"))
      .def_prop_ro("width", &NormalMap::width)
      .def_prop_ro("height", &NormalMap::height)
      .def_prop_ro("interpolation",
                   [](const NormalMap& map) { return static_cast<int>(map.interpolation()); })
      .def_prop_ro("normals", &normals_of)
      .def_prop_ro("notes", &NormalMap::notes);
}

}  // namespace mica::python
