#include <fmt/format.h>

#include <algorithm>
#include <variant>

#include "host/job/read_job.h"

namespace mica::host {
namespace {

// What synthesis takes; a map of 16384^2 normals is 4 GiB.
const Interval kResolutions = closed(4, 16384);
const Interval kDirections = closed(-360, 360);  // degrees

/// A default that is too large for the job's other settings.
void limit(double& value, double greatest) {
  value = std::min(value, greatest);
}

SurfaceDescription read_map_file(TableReader& surface) {
  MapFile map;
  surface.read_file("file", map.path);
  surface.read_choice(map.choice);
  map.encoding_given = surface.has("encoding");
  surface.read("encoding", map.encoding);
  surface.read("green", map.green);
  surface.read("invalid", map.invalid);
  surface.read("precision", map.precision);
  surface.read("height_scale", map.height_scale, open_low(0, 1e6));
  if (surface.has("height_scale") && map.encoding != Encoding::height) {
    surface.report("height_scale", "found a scale of heights; expected encoding = \"height\" with it");
  }
  return {surface.name(), map, Interpolation::bilinear};
}

SurfaceDescription read_spectrum(TableReader& surface) {
  SpectrumSurface spectrum;
  surface.read("resolution", spectrum.resolution, kResolutions);
  surface.read("rms_slope", spectrum.rms_slope, closed(0, 5));
  surface.read("correlation", spectrum.correlation_texels, open_low(0, spectrum.resolution));
  surface.read("seed", spectrum.seed);
  return {surface.name(), spectrum, Interpolation::bilinear};
}

SurfaceDescription read_flakes(TableReader& surface) {
  FlakesSurface flakes;
  surface.read("resolution", flakes.resolution, kResolutions);
  surface.read("flake_size", flakes.flake_size_texels, closed(1, flakes.resolution / 4.0));
  surface.read("alpha", flakes.alpha, closed(0, 2));
  surface.read("seed", flakes.seed);
  return {surface.name(), flakes, Interpolation::nearest};
}

SurfaceDescription read_brushed(TableReader& surface) {
  BrushedSurface brushed;
  surface.read("resolution", brushed.resolution, kResolutions);
  const Interval correlations = closed(1e-3, brushed.resolution);
  limit(brushed.correlation_along_texels, brushed.resolution);
  surface.read("rms_slope", brushed.rms_slope, closed(0, 5));
  surface.read("correlation_along", brushed.correlation_along_texels, correlations);
  surface.read("correlation_across", brushed.correlation_across_texels, correlations);
  surface.read("direction", brushed.direction_degrees, kDirections);
  surface.read("seed", brushed.seed);
  return {surface.name(), brushed, Interpolation::bilinear};
}

SurfaceDescription read_scratches(TableReader& surface) {
  ScratchesSurface scratches;
  surface.read("resolution", scratches.resolution, kResolutions);
  surface.read("density", scratches.density, closed(0, 4));
  limit(scratches.length_texels, scratches.resolution);
  surface.read("length", scratches.length_texels, closed(2, scratches.resolution));
  limit(scratches.width_texels, scratches.length_texels);
  surface.read("width", scratches.width_texels, closed(1, scratches.length_texels));
  limit(scratches.depth_texels, scratches.width_texels);
  surface.read("depth", scratches.depth_texels, closed(0, scratches.width_texels));
  surface.read("variation", scratches.variation, closed(0, 0.9));
  surface.read("direction", scratches.direction_degrees, kDirections);
  surface.read("spread", scratches.spread_degrees, closed(0, 90));
  surface.read("bend", scratches.bend, closed(0, 0.2));
  surface.read("profile", scratches.profile);
  surface.read("seed", scratches.seed);
  return {surface.name(), scratches, Interpolation::bilinear};
}

SurfaceDescription read_dents(TableReader& surface) {
  DentsSurface dents;
  surface.read("resolution", dents.resolution, kResolutions);
  surface.read("density", dents.density, closed(0, 16));
  limit(dents.radius_low_texels, dents.resolution);
  limit(dents.radius_high_texels, dents.resolution);
  Eigen::Vector2d radius(dents.radius_low_texels, dents.radius_high_texels);
  surface.read("radius", radius, closed(1, dents.resolution));
  if (radius[1] < radius[0]) {
    surface.report("radius", fmt::format("found {} before {}; expected the least before the greatest",
                                         radius[0], radius[1]));
  }
  dents.radius_low_texels = radius[0], dents.radius_high_texels = radius[1];
  surface.read("depth", dents.depth, closed(0, 1));
  surface.read("seed", dents.seed);
  return {surface.name(), dents, Interpolation::bilinear};
}

SurfaceDescription read_bumps(TableReader& surface) {
  BumpsSurface bumps;
  surface.read("resolution", bumps.resolution, kResolutions);
  limit(bumps.cell_texels, bumps.resolution);
  surface.read("cell", bumps.cell_texels, closed(4, bumps.resolution));
  surface.read("size", bumps.size, closed(1e-3, 2));
  surface.read("aspect", bumps.aspect, closed(1, 10));
  surface.read("slope", bumps.slope, closed(0, 5));
  surface.read("jitter", bumps.jitter, closed(0, 1));
  surface.read("seed", bumps.seed);
  return {surface.name(), bumps, Interpolation::bilinear};
}

SurfaceDescription read_waves(TableReader& surface) {
  WavesSurface waves;
  surface.read("resolution", waves.resolution, kResolutions);
  surface.read("patch", waves.patch_meters, closed(1e-6, 1e6));
  surface.read("wind_speed", waves.wind_speed, closed(1e-6, 100));
  surface.read("wind_direction", waves.wind_direction_degrees, kDirections);
  surface.read("time", waves.time_seconds, closed(-1e6, 1e6));
  surface.read("time_scale", waves.time_scale, closed(0, 1e3));
  surface.read("seed", waves.seed);
  return {surface.name(), waves, Interpolation::bilinear};
}

/// What the layers are is read once all other surfaces are known.
SurfaceDescription read_layers_later(TableReader& surface) {
  surface.accept_any_key();
  return {surface.name(), LayersSurface{}, Interpolation::bilinear};
}

// Texels a side of a surface as far as the job says; 0 when it does not.
int resolution_of(const MapFile&) {
  return 0;
}
int resolution_of(const LayersSurface&) {
  return 0;
}
template <typename Synthesised>
int resolution_of(const Synthesised& surface) {
  return surface.resolution;
}

bool is_layered(const SurfaceDescription& surface) {
  return std::holds_alternative<LayersSurface>(surface.source);
}

/// A layer is a surface that has none itself: a sum of sums is a sum, and none can contain itself.
LayersSurface read_layers(TableReader& table, const std::vector<SurfaceDescription>& surfaces) {
  std::vector<std::string_view> names;
  for (const SurfaceDescription& surface : surfaces) names.push_back(surface.name);
  LayersSurface result;
  int resolution = 0;
  table.read_table_array("layers", [&](TableReader& layer) {
    std::string name;
    double weight = 1;
    layer.read("weight", weight, closed(-100, 100));
    if (layer.require("surface", "the name of a surface that is not made of layers"))
      layer.read_reference("surface", name, "surface", names);
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) return;
    const SurfaceDescription& surface = surfaces[static_cast<std::size_t>(found - names.begin())];
    if (is_layered(surface)) {
      layer.report(
          "surface",
          fmt::format("found \"{}\", which is made of layers itself; expected a surface that is not", name));
      return;
    }
    const int size = std::visit([](const auto& source) { return resolution_of(source); }, surface.source);
    if (resolution == 0) resolution = size;
    if (size != 0 && size != resolution) {
      layer.report("surface", fmt::format("found a resolution of {}; expected {}, as of the layers before it",
                                          size, resolution));
    }
    result.layers.push_back({surface, weight});
  });
  return result;
}

using SurfaceReader = SurfaceDescription (*)(TableReader&);

const Choices<SurfaceReader> kKinds = {{"spectrum", read_spectrum}, {"flakes", read_flakes},
                                       {"brushed", read_brushed},   {"scratches", read_scratches},
                                       {"dents", read_dents},       {"bumps", read_bumps},
                                       {"waves", read_waves},       {"layers", read_layers_later}};

/// The reader of the surface's kind, null with a report when the kind is not clear.
SurfaceReader choose_reader(TableReader& surface) {
  if (surface.has("file") == surface.has("generate")) {
    const char* found = surface.has("file") ? "both" : "neither";
    surface.report(fmt::format("found {} of \"file\" and \"generate\"; expected exactly one", found));
    return nullptr;
  }
  SurfaceReader reader = surface.has("file") ? read_map_file : nullptr;
  surface.read("generate", reader, kKinds);
  return reader;
}

}  // namespace

std::vector<SurfaceDescription> read_surfaces(TableReader& job) {
  std::vector<SurfaceDescription> surfaces;
  job.read_named_tables("surface", [&](TableReader& surface) {
    const SurfaceReader read = choose_reader(surface);
    if (!read) {
      surface.accept_any_key();
      surfaces.push_back({surface.name(), MapFile{}, Interpolation::bilinear});  // materials may refer to it
      return;
    }
    surfaces.push_back(read(surface));
    if (!is_layered(surfaces.back())) surface.read("interpolation", surfaces.back().interpolation);
  });
  job.read_table("surface", [&](TableReader& tables) {
    tables.accept_any_key();
    for (SurfaceDescription& surface : surfaces) {
      if (!is_layered(surface)) continue;
      tables.read_table(surface.name, [&](TableReader& table) {
        choose_reader(table);
        table.read("interpolation", surface.interpolation);
        surface.source = read_layers(table, surfaces);
      });
    }
  });
  return surfaces;
}

}  // namespace mica::host
