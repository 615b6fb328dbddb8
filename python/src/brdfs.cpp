#include "python/src/columns.h"

namespace mica::python {
namespace {

Brdf make_brdf(const Device& device, const NormalMap* map, const std::string& method,
               const SettingTexts& settings) {
  return without_gil([&] {
    return map ? Brdf(device, *map, method, to_settings(settings))
               : Brdf(device, method, to_settings(settings));
  });
}

void evaluate_brdf(const Brdf& brdf, std::size_t count, const ColumnDict& columns, int part,
                   const Room& values, const CancellationToken& cancellation, nb::handle report) {
  Columns table(count, columns);
  const Lightings queries = table.lightings();
  const RunControl control = to_control(cancellation, report);
  without_gil([&] { brdf.evaluate(queries, to_span(values), static_cast<BrdfPart>(part), control); });
}

void energy(const Brdf& brdf, std::size_t count, const ColumnDict& columns, const Room& albedos,
            const CancellationToken& cancellation, nb::handle report) {
  Columns table(count, columns);
  const Views views = table.views();
  const RunControl control = to_control(cancellation, report);
  without_gil([&] { brdf.energy(views, to_span(albedos), control); });
}

void sample(const Brdf& brdf, std::size_t count, const ColumnDict& columns, std::uint64_t seed,
            const Room& samples, const CancellationToken& cancellation, nb::handle report) {
  Columns table(count, columns);
  const Views views = table.views();
  const RunControl control = to_control(cancellation, report);
  without_gil([&] { brdf.sample(views, seed, to_span(samples), control); });
}

}  // namespace

void bind_brdfs(nb::module_& module) {
  nb::class_<Brdf>(module, "Brdf")
      .def_static("make", &make_brdf, nb::arg("device"), nb::arg("map").none(), nb::arg("method"),
                  nb::arg("settings"))
      .def("evaluate", &evaluate_brdf, nb::arg("count"), nb::arg("columns"), nb::arg("part"),
           nb::arg("values").noconvert(), nb::arg("cancellation"), nb::arg("report").none())
      .def("energy", &energy, nb::arg("count"), nb::arg("columns"), nb::arg("albedos").noconvert(),
           nb::arg("cancellation"), nb::arg("report").none())
      .def("sample", &sample, nb::arg("count"), nb::arg("columns"), nb::arg("seed"),
           nb::arg("samples").noconvert(), nb::arg("cancellation"), nb::arg("report").none())
      .def_prop_ro("device_bytes", &Brdf::device_bytes)
      .def_prop_ro("build_seconds", &Brdf::build_seconds)
      .def_prop_ro("device_seconds", &Brdf::device_seconds);
}

}  // namespace mica::python
