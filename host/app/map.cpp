// mica map: synthesises a normal map.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <functional>
#include <memory>

#include "host/app/commands.h"
#include "host/app/evaluation.h"
#include "host/app/map_options.h"
#include "host/app/output.h"
#include "host/image/image.h"
#include "host/job/input_files.h"
#include "host/surface/export.h"
#include "mica/error.h"
#include "mica/version.h"

namespace mica::host::app {
namespace {

int run(const SurfaceDescription& description, const std::string& recipe, const std::string& output) {
  check_extension(output, {".exr"});
  const Outputs outputs({output}, input_files(description));
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

/// One KIND of map on the command line: its options, and the recipe that the file keeps.
class Kind {
 public:
  Kind(CommandLine* map, const std::string& name, const std::string& description)
      : name_(name), app_(map->add_subcommand(name, description)) {
    app_->add_option("-o,--output", *output_, "The map: EXR, three float channels, signed, green up")
        .required()
        .type_name("FILE");
  }

  /// @param value at its default; has to live as long as the command.
  template <typename T>
  Option add(const std::string& option, T* value, const std::string& type, const std::string& description) {
    recipe_.push_back([=] { return fmt::format(" {} {}", option, *value); });
    return app_->add_option(option, *value, description).type_name(type).show_default();
  }

  template <typename Source>
  void add_resolution_and_seed(Source* source) {
    add("--resolution", &source->resolution, "TEXELS", "Texels a side");
    add("--seed", &source->seed, "N", "Of the random numbers; the same seed gives the same map everywhere");
  }

  void footer(const std::string& text) { app_->footer(text); }

  /// @param describe returns the map's description, once the options are read.
  template <typename Describe>
  void choose(Command* chosen, Interpolation interpolation, Describe describe) {
    app_->callback([=, kind = *this] {
      *chosen = [=] {
        std::string recipe = kind.name_;
        for (const auto& option : kind.recipe_) recipe += option();
        return run({kind.name_, describe(), interpolation}, recipe, *kind.output_);
      };
    });
  }

 private:
  std::string name_;
  CommandLine* app_;
  std::shared_ptr<std::string> output_ = std::make_shared<std::string>();
  std::vector<std::function<std::string()>> recipe_;
};

void add_spectrum(CommandLine* map, Command* chosen) {
  auto spectrum = std::make_shared<SpectrumSurface>();
  Kind kind(map, "spectrum", "Random bumps: a heightfield with a Gaussian power spectrum");
  kind.add_resolution_and_seed(spectrum.get());
  kind.add("--rms-slope", &spectrum->rms_slope, "SLOPE", "Root mean square slope: rise over run");
  kind.add("--correlation", &spectrum->correlation_texels, "TEXELS",
           "Distance at which the height's autocorrelation falls to 1/e: the size of the bumps");
  kind.choose(chosen, Interpolation::bilinear, [=] { return *spectrum; });
}

void add_flakes(CommandLine* map, Command* chosen) {
  auto flakes = std::make_shared<FlakesSurface>();
  Kind kind(map, "flakes", "Metallic flakes: Voronoi cells, each with one Beckmann-distributed normal");
  kind.add_resolution_and_seed(flakes.get());
  kind.add("--flake-size", &flakes->flake_size_texels, "TEXELS",
           "Mean distance between neighbouring flakes' centres");
  kind.add("--alpha", &flakes->alpha, "ALPHA", "Beckmann roughness of the flakes' normals");
  kind.footer("Read such a map with --interpolation nearest: a flake has one normal, up to its edge.");
  kind.choose(chosen, Interpolation::nearest, [=] { return *flakes; });
}

void add_brushed(CommandLine* map, Command* chosen) {
  auto brushed = std::make_shared<BrushedSurface>();
  Kind kind(map, "brushed", "Brushed metal: a Gaussian heightfield, stretched along the brushing");
  kind.add_resolution_and_seed(brushed.get());
  kind.add("--rms-slope", &brushed->rms_slope, "SLOPE", "Root mean square slope: rise over run");
  kind.add("--correlation-along", &brushed->correlation_along_texels, "TEXELS",
           "Distance at which the height's autocorrelation falls to 1/e, along the brushing");
  kind.add("--correlation-across", &brushed->correlation_across_texels, "TEXELS", "The same across it");
  kind.add("--direction", &brushed->direction_degrees, "DEGREES", "Of the brushing, from u towards v");
  kind.choose(chosen, Interpolation::bilinear, [=] { return *brushed; });
}

void add_scratches(CommandLine* map, Command* chosen) {
  auto scratches = std::make_shared<ScratchesSurface>();
  auto profile = std::make_shared<std::string>("rounded");
  Kind kind(map, "scratches", "Random scratches in a flat surface");
  kind.add_resolution_and_seed(scratches.get());
  kind.add("--density", &scratches->density, "SHARE",
           "Length times width of all scratches, over the map's area");
  kind.add("--length", &scratches->length_texels, "TEXELS", "Mean length");
  kind.add("--width", &scratches->width_texels, "TEXELS", "Mean width");
  kind.add("--depth", &scratches->depth_texels, "TEXELS", "Mean of the deepest point");
  kind.add("--variation", &scratches->variation, "SHARE",
           "Length, width and depth vary, each for itself, by up to this share");
  kind.add("--direction", &scratches->direction_degrees, "DEGREES", "Mean direction, from u towards v");
  kind.add("--spread", &scratches->spread_degrees, "DEGREES",
           "Directions are uniform up to this far from the mean; 90: all directions");
  kind.add("--bend", &scratches->bend, "SHARE",
           "Scratches bulge up to this far from straight, over their length");
  kind.add("--profile", profile.get(), "NAME", "v, or rounded, which has a raised rim")
      .check(one_of({"v", "rounded"}));
  kind.choose(chosen, Interpolation::bilinear, [=] {
    scratches->profile = *profile == "v" ? ScratchProfile::v : ScratchProfile::rounded;
    return *scratches;
  });
}

void add_dents(CommandLine* map, Command* chosen) {
  auto dents = std::make_shared<DentsSurface>();
  Kind kind(map, "dents", "Smooth round dents at random places");
  kind.add_resolution_and_seed(dents.get());
  kind.add("--density", &dents->density, "SHARE", "Area of all dents, over the map's");
  kind.add("--radius-low", &dents->radius_low_texels, "TEXELS", "Least radius");
  kind.add("--radius-high", &dents->radius_high_texels, "TEXELS", "Greatest radius");
  kind.add("--depth", &dents->depth, "SHARE", "Of a dent, over its radius");
  kind.choose(chosen, Interpolation::bilinear, [=] { return *dents; });
}

void add_bumps(CommandLine* map, Command* chosen) {
  auto bumps = std::make_shared<BumpsSurface>();
  Kind kind(map, "bumps", "Bumpy plastic: caps of ellipsoids on a jittered grid");
  kind.add_resolution_and_seed(bumps.get());
  kind.add("--cell", &bumps->cell_texels, "TEXELS", "Side of the grid's cells");
  kind.add("--size", &bumps->size, "SHARE", "Length of a bump, over the cell's side");
  kind.add("--aspect", &bumps->aspect, "RATIO", "Length of a bump, over its width");
  kind.add("--slope", &bumps->slope, "SLOPE", "The steepest of a bump, at its rim");
  kind.add("--jitter", &bumps->jitter, "SHARE", "Centres are uniform over this share of their cell's sides");
  kind.choose(chosen, Interpolation::bilinear, [=] { return *bumps; });
}

void add_waves(CommandLine* map, Command* chosen) {
  auto waves = std::make_shared<WavesSurface>();
  Kind kind(map, "waves", "Wind sea in deep water, at one moment");
  kind.add_resolution_and_seed(waves.get());
  kind.add("--patch", &waves->patch_meters, "METRES", "Side of the map");
  kind.add("--wind-speed", &waves->wind_speed, "M/S", "Metres a second, 19.5 m above the sea");
  kind.add("--wind-direction", &waves->wind_direction_degrees, "DEGREES",
           "That the waves run in, from u towards v");
  kind.add("--time", &waves->time_seconds, "SECONDS", "The moment");
  kind.choose(chosen, Interpolation::bilinear, [=] { return *waves; });
}

LayersSurface layers_of_files(const std::vector<std::string>& paths, std::vector<double> weights) {
  if (weights.empty()) weights.assign(paths.size(), 1.0);
  if (weights.size() != paths.size()) {
    throw UsageError(fmt::format("--weight: found {}, expected none or as many as layers ({})",
                                 weights.size(), paths.size()));
  }
  LayersSurface layers;
  for (std::size_t n = 0; n < paths.size(); ++n) {
    MapFile file;
    file.path = paths[n];
    layers.layers.push_back({{paths[n], file, Interpolation::bilinear}, weights[n]});
  }
  return layers;
}

void add_layers(CommandLine* map, Command* chosen) {
  auto paths = std::make_shared<std::vector<std::string>>();
  auto weights = std::make_shared<std::vector<double>>();
  Kind kind(map, "layers", "Sum of the slopes of other maps of one size");
  kind.add("--layer", paths.get(), "FILE", "A normal map; given as often as there are layers")
      .required()
      .repeated();
  kind.add("--weight", weights.get(), "FACTOR",
           "Of the slopes of the layer in the same place; default: 1 of each")
      .repeated();
  kind.choose(chosen, Interpolation::bilinear, [=] { return layers_of_files(*paths, *weights); });
}

}  // namespace

void add_map(CommandLine& app, Command* chosen, const MethodRegistry&) {
  CommandLine* map = app.add_subcommand("map", "Synthesises a normal map");
  map->require_subcommand();
  for (const auto add :
       {add_spectrum, add_flakes, add_brushed, add_scratches, add_dents, add_bumps, add_waves, add_layers}) {
    add(map, chosen);
  }
}

}  // namespace mica::host::app
