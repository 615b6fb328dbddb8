#include "host/app/map_options.h"

#include <spdlog/spdlog.h>

#include "host/base/printable.h"
#include "host/surface/map_precision.h"

namespace mica::host::app {
namespace {

template <typename Enum>
Values words_of() {
  return one_of(list_words<Enum>());
}

}  // namespace

void add_map_options(CommandLine* command, MapOptions* options) {
  command->add_option("--map", options->path, "Normal map: an image file, see docs/files.md")
      .type_name("FILE");
  command->add_option("--map-part", options->part, "Name or number from 0 of the file's part or page")
      .type_name("NAME");
  command
      ->add_option(
          "--map-channels", options->channels,
          "Layer of the file, or names with commas between; default: X, Y, Z or R, G, B, or what is there")
      .type_name("NAMES");
  command
      ->add_option("--encoding", options->encoding,
                   "What its pixels are: unorm (n = 2c - 1), signed (n = c), height or slope; "
                   "default: unorm for integer pixels and floats that are 0..1, signed for other floats")
      .type_name("NAME")
      .check(words_of<Encoding>());
  command->add_option("--green", options->green, "Where a positive green channel leans: up or down the image")
      .type_name("NAME")
      .check(words_of<GreenDirection>())
      .show_default();
  command
      ->add_option("--interpolation", options->interpolation,
                   "Of the normals between texels: nearest, bilinear or bicubic (Catmull-Rom)")
      .type_name("NAME")
      .check(words_of<Interpolation>())
      .show_default();
  command
      ->add_option(
          "--invalid", options->invalid,
          "Texels that are NaN, infinite or of zero length: refuse the map, or repair them from their "
          "neighbours")
      .type_name("NAME")
      .check(words_of<TexelRepair>())
      .show_default();
  command
      ->add_option("--height-scale", options->height_scale,
                   "For encoding height: texels of height per unit of the image's value")
      .type_name("TEXELS")
      .show_default();
  command
      ->add_option(
          "--precision", options->precision,
          "Of normals that a file tells in steps: as they are, restored between the steps where their "
          "neighbours tell, or with lobes that are wider by the variance of rounding")
      .type_name("NAME")
      .check(words_of<Precision>())
      .show_default();
  add_max_memory(command, &options->max_memory);
}

Surface load_map(const MapOptions& options, SurfaceReport* report) {
  MapFile file;
  file.path = options.path;
  file.choice = {options.part, options.channels, options.max_memory.bytes()};
  file.encoding_given = !options.encoding.empty();
  if (file.encoding_given) file.encoding = parse_word<Encoding>(options.encoding).value();
  file.green = parse_word<GreenDirection>(options.green).value();
  file.invalid = parse_word<TexelRepair>(options.invalid).value();
  file.height_scale = options.height_scale;
  file.precision = parse_word<Precision>(options.precision).value();
  SurfaceDescription description;
  description.name = "map";
  description.source = file;
  description.interpolation = parse_word<Interpolation>(options.interpolation).value();
  Surface surface = make_surface(description, report);
  log_report(*report);
  return surface;
}

void log_precision(const Surface& surface, double roughness) {
  SurfaceReport report;
  report_precision(surface, roughness, &report);
  log_report(report);
}

void log_report(const SurfaceReport& report) {
  for (const std::string& note : report.notes) spdlog::info(printable(note));
  for (const std::string& warning : report.warnings) spdlog::warn(printable(warning));
}

}  // namespace mica::host::app
