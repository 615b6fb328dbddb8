// mica map: synthesises a normal map.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "host/app/commands.h"
#include "host/app/evaluation.h"
#include "host/app/map_options.h"
#include "host/app/output.h"
#include "host/base/version.h"
#include "host/image/image.h"
#include "host/surface/export.h"

namespace mica::app {
namespace {

int run(const SurfaceDescription& description, const std::string& recipe, const std::string& output) {
  check_extension(output, {".exr"});
  prepare_output(output);
  SurfaceReport report;
  const Surface surface = make_surface(description, &report);
  log_report(report);
  Image image;
  image.width = surface.width(), image.height = surface.height();
  image.channels = {"R", "G", "B"};
  image.pixels = to_signed_rgb(surface);
  image.metadata = {{"mica:version", version()}, {"mica:map", recipe}};
  write_exr(output, image);
  spdlog::info("wrote {}: {} x {} texels, encoding signed, green up", output, image.width, image.height);
  return 0;
}

CLI::App* add_kind(CLI::App* map, const std::string& name, const std::string& description, int* resolution,
                   std::uint64_t* seed, std::string* output) {
  CLI::App* kind = map->add_subcommand(name, description);
  kind->add_option("--resolution", *resolution, "Texels a side")->type_name("TEXELS")->capture_default_str();
  kind->add_option("--seed", *seed, "Of the random numbers; the same seed gives the same map everywhere")
      ->type_name("N")
      ->capture_default_str();
  kind->add_option("-o,--output", *output, "The map: EXR, three float channels, signed, green up")
      ->required()
      ->type_name("FILE");
  return kind;
}

void add_spectrum(CLI::App* map, Command* chosen) {
  auto spectrum = std::make_shared<SpectrumSurface>();
  auto output = std::make_shared<std::string>();
  CLI::App* kind = add_kind(map, "spectrum", "Random bumps: a heightfield with a Gaussian power spectrum",
                            &spectrum->resolution, &spectrum->seed, output.get());
  kind->add_option("--rms-slope", spectrum->rms_slope, "Root mean square slope: rise over run")
      ->type_name("SLOPE")
      ->capture_default_str();
  kind->add_option("--correlation", spectrum->correlation_texels,
                   "Distance at which the height's autocorrelation falls to 1/e: the size of the bumps")
      ->type_name("TEXELS")
      ->capture_default_str();
  kind->callback([=] {
    *chosen = [=] {
      const std::string recipe = fmt::format(
          "spectrum --resolution {} --rms-slope {} --correlation {} --seed {}", spectrum->resolution,
          spectrum->rms_slope, spectrum->correlation_texels, spectrum->seed);
      return run({"spectrum", *spectrum, Interpolation::bilinear}, recipe, *output);
    };
  });
}

void add_flakes(CLI::App* map, Command* chosen) {
  auto flakes = std::make_shared<FlakesSurface>();
  auto output = std::make_shared<std::string>();
  CLI::App* kind =
      add_kind(map, "flakes", "Metallic flakes: Voronoi cells, each with one Beckmann-distributed normal",
               &flakes->resolution, &flakes->seed, output.get());
  kind->add_option("--flake-size", flakes->flake_size_texels,
                   "Mean distance between neighbouring flakes' centres")
      ->type_name("TEXELS")
      ->capture_default_str();
  kind->add_option("--alpha", flakes->alpha, "Beckmann roughness of the flakes' normals")
      ->type_name("ALPHA")
      ->capture_default_str();
  kind->footer("Read such a map with --interpolation nearest: a flake has one normal, up to its edge.");
  kind->callback([=] {
    *chosen = [=] {
      const std::string recipe =
          fmt::format("flakes --resolution {} --flake-size {} --alpha {} --seed {}", flakes->resolution,
                      flakes->flake_size_texels, flakes->alpha, flakes->seed);
      return run({"flakes", *flakes, Interpolation::nearest}, recipe, *output);
    };
  });
}

}  // namespace

void add_map(CLI::App& app, Command* chosen) {
  CLI::App* map = app.add_subcommand("map", "Synthesises a normal map");
  map->require_subcommand(1);
  add_spectrum(map, chosen);
  add_flakes(map, chosen);
}

}  // namespace mica::app
