#include "python/src/bindings.h"

namespace mica::python {
namespace {

/// The image's own memory, which lives as long as the array.
nb::ndarray<nb::numpy, float, nb::ndim<3>> pixels_of(nb::handle_t<Image> self) {
  auto& image = nb::cast<Image&>(self);
  return {
      image.pixels.data(),
      {static_cast<std::size_t>(image.height), static_cast<std::size_t>(image.width), image.channels.size()},
      self};
}

/// @param pixels (height, width, channels).
Image make_image(const nb::ndarray<const float, nb::ndim<3>, nb::c_contig, nb::device::cpu>& pixels,
                 std::vector<std::string> channels, std::map<std::string, std::string> metadata,
                 double exposure_stops, std::string tone_map) {
  Image image;
  image.height = static_cast<int>(pixels.shape(0)), image.width = static_cast<int>(pixels.shape(1));
  image.channels = std::move(channels), image.metadata = std::move(metadata);
  image.pixels.assign(pixels.data(), pixels.data() + pixels.size());
  image.exposure_stops = exposure_stops, image.tone_map = std::move(tone_map);
  return image;
}

Image render(const Renderer& renderer, int frame, const CancellationToken& cancellation, nb::handle report) {
  const RunControl control = to_control(cancellation, report);
  return without_gil([&] { return renderer.render(frame, control); });
}

}  // namespace

void bind_jobs(nb::module_& module) {
  nb::class_<Image>(module, "Image")
      .def_static("make", &make_image, nb::arg("pixels"), nb::arg("channels"), nb::arg("metadata"),
                  nb::arg("exposure_stops"), nb::arg("tone_map"))
      .def_ro("channels", &Image::channels)
      .def_prop_ro("pixels", &pixels_of)
      .def_ro("metadata", &Image::metadata)
      .def_ro("notes", &Image::notes)
      .def_ro("exposure_stops", &Image::exposure_stops)
      .def_ro("tone_map", &Image::tone_map)
      .def(
          "write",
          [](const Image& image, const nb::bytes& path, double exposure_stops) {
            const std::string name = to_text(path);
            without_gil([&] { write(image, name, exposure_stops); });
          },
          nb::arg("path"), nb::arg("exposure_stops"));

  nb::class_<Job>(module, "Job")
      .def_static(
          "load",
          [](const nb::bytes& path, const std::vector<std::string>& overrides) {
            const std::string name = to_text(path);
            return without_gil([&] { return Job::load(name, overrides); });
          },
          nb::arg("path"), nb::arg("overrides"))
      .def_static(
          "parse",
          [](const std::string& text, const nb::bytes& folder, const std::vector<std::string>& overrides) {
            const std::string name = to_text(folder);
            return without_gil([&] { return Job::parse(text, name, overrides); });
          },
          nb::arg("text"), nb::arg("folder"), nb::arg("overrides"))
      .def_prop_ro("width", &Job::width)
      .def_prop_ro("height", &Job::height)
      .def_prop_ro("first_frame", &Job::first_frame)
      .def_prop_ro("last_frame", &Job::last_frame)
      .def("plan", &Job::plan, nb::call_guard<nb::gil_scoped_release>());

  nb::class_<Renderer>(module, "Renderer")
      .def(nb::init<const Device&, const Job&>(), nb::arg("device"), nb::arg("job"),
           nb::call_guard<nb::gil_scoped_release>())
      .def("render", &render, nb::arg("frame"), nb::arg("cancellation"), nb::arg("report").none());
}

}  // namespace mica::python
