#include "python/src/bindings.h"

namespace mica::python {

void bind_glints(nb::module_& module) {
  nb::class_<GlintSettings>(module, "GlintSettings")
      .def(nb::init<>())
      .def_rw("preset", &GlintSettings::preset)
      .def_rw("channels", &GlintSettings::channels)
      .def_rw("skips_other_ids", &GlintSettings::skips_other_ids)
      .def_rw("filter", &GlintSettings::filter)
      .def_rw("filter_width", &GlintSettings::filter_width)
      .def_rw("scale", &GlintSettings::scale)
      .def_rw("per_lamp", &GlintSettings::per_lamp)
      .def_rw("aovs", &GlintSettings::aovs)
      .def_rw("overrides", &GlintSettings::overrides);

  nb::class_<GlintLayer>(module, "GlintLayer")
      .def_ro("channels", &GlintLayer::channels)
      .def_ro("covered", &GlintLayer::covered)
      .def_ro("one_sided", &GlintLayer::one_sided)
      .def_ro("without_footprint", &GlintLayer::without_footprint)
      .def_ro("broken", &GlintLayer::broken)
      .def_ro("queries", &GlintLayer::queries)
      .def_ro("notes", &GlintLayer::notes);

  module.def(
      "write_glints",
      [](const Device& device, const nb::bytes& buffer, const nb::bytes& scene, const nb::bytes& path,
         const nb::bytes& camera, GlintSettings settings, const CancellationToken& cancellation,
         nb::handle report) {
        settings.camera = to_text(camera);
        const std::string buffer_name = to_text(buffer), scene_name = to_text(scene), name = to_text(path);
        const RunControl control = to_control(cancellation, report);
        return without_gil(
            [&] { return write_glints(device, buffer_name, scene_name, name, settings, control); });
      },
      nb::arg("device"), nb::arg("buffer"), nb::arg("scene"), nb::arg("path"), nb::arg("camera"),
      nb::arg("settings"), nb::arg("cancellation"), nb::arg("report").none());
}

}  // namespace mica::python
