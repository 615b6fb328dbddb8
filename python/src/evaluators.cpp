#include <nanobind/stl/optional.h>

#include "python/src/columns.h"

namespace mica::python {
namespace {

Evaluator make_evaluator(const Device& device, const NormalMap* map, const std::string& method,
                         const SettingTexts& settings) {
  return without_gil([&] {
    return map ? Evaluator(device, *map, method, to_settings(settings))
               : Evaluator(device, method, to_settings(settings));
  });
}

void evaluate_densities(const Evaluator& evaluator, std::size_t count, const ColumnDict& columns,
                        const Room& densities, const CancellationToken& cancellation, nb::handle report) {
  Columns table(count, columns);
  const Queries queries = table.queries();
  const RunControl control = to_control(cancellation, report);
  without_gil([&] { evaluator.evaluate(queries, to_span(densities), control); });
}

void estimate_errors(const Evaluator& evaluator, std::size_t count, const ColumnDict& columns,
                     const Room& densities, const Room& errors) {
  Columns table(count, columns);
  const Queries queries = table.queries();
  without_gil([&] {
    evaluator.estimate_errors(queries, Span<const float>(densities.data(), densities.size()),
                              to_span(errors));
  });
}

/// @param window (s, t, radius).
void draw(const Evaluator& evaluator, std::size_t count, const ColumnDict& columns,
          const std::vector<double>& window, int pixels, const Room& images,
          const CancellationToken& cancellation, nb::handle report) {
  Columns table(count, columns);
  const Footprints footprints = table.footprints();
  const Column roughness = table.roughness();
  const RunControl control = to_control(cancellation, report);
  const PndfWindow inside{window.at(0), window.at(1), window.at(2), pixels};
  without_gil([&] { evaluator.draw(footprints, roughness, inside, to_span(images), control); });
}

}  // namespace

void bind_evaluators(nb::module_& module) {
  nb::class_<Evaluator>(module, "Evaluator")
      .def_static("make", &make_evaluator, nb::arg("device"), nb::arg("map").none(), nb::arg("method"),
                  nb::arg("settings"))
      .def("evaluate", &evaluate_densities, nb::arg("count"), nb::arg("columns"),
           nb::arg("densities").noconvert(), nb::arg("cancellation"), nb::arg("report").none())
      .def("estimate_errors", &estimate_errors, nb::arg("count"), nb::arg("columns"), nb::arg("densities"),
           nb::arg("errors").noconvert())
      .def("draw", &draw, nb::arg("count"), nb::arg("columns"), nb::arg("window"), nb::arg("pixels"),
           nb::arg("images").noconvert(), nb::arg("cancellation"), nb::arg("report").none())
      .def_prop_ro("method", &Evaluator::method)
      .def_prop_ro("choices", &Evaluator::choices)
      .def_prop_ro("device_bytes", &Evaluator::device_bytes)
      .def_prop_ro("build_seconds", &Evaluator::build_seconds)
      .def_prop_ro("device_seconds", &Evaluator::device_seconds);
}

}  // namespace mica::python
