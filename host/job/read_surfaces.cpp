#include <fmt/format.h>

#include "host/job/read_job.h"

namespace mica {
namespace {

// What synthesis takes; a map of 16384^2 normals is 4 GiB.
const Interval resolutions = closed(4, 16384);

const Choices<Interpolation> interpolations = {{"nearest", Interpolation::nearest},
                                               {"bilinear", Interpolation::bilinear},
                                               {"bicubic", Interpolation::bicubic}};
const Choices<Encoding> encodings = {{"unorm", Encoding::unorm},
                                     {"signed", Encoding::signed_float},
                                     {"height", Encoding::height},
                                     {"slope", Encoding::slope}};
const Choices<GreenDirection> green_directions = {{"up", GreenDirection::up}, {"down", GreenDirection::down}};
const Choices<TexelRepair> repairs = {{"repair", TexelRepair::repair}, {"refuse", TexelRepair::refuse}};

SurfaceDescription read_map_file(TableReader& surface) {
  MapFile map;
  surface.read_file("file", map.path);
  map.encoding_given = surface.has("encoding");
  surface.read("encoding", map.encoding, encodings);
  surface.read("green", map.green, green_directions);
  surface.read("invalid", map.invalid, repairs);
  surface.read("height_scale", map.height_scale, open_low(0, 1e6));
  if (surface.has("height_scale") && map.encoding != Encoding::height) {
    surface.report("height_scale", "found a scale of heights; expected encoding = \"height\" with it");
  }
  return {surface.name(), map, Interpolation::bilinear};
}

SurfaceDescription read_spectrum(TableReader& surface) {
  SpectrumSurface spectrum;
  surface.read("resolution", spectrum.resolution, resolutions);
  if ((spectrum.resolution & (spectrum.resolution - 1)) != 0) {
    surface.report("resolution", fmt::format("found {}; expected a power of two", spectrum.resolution));
  }
  surface.read("rms_slope", spectrum.rms_slope, closed(0, 5));
  surface.read("correlation", spectrum.correlation_texels, open_low(0, spectrum.resolution));
  surface.read("seed", spectrum.seed);
  return {surface.name(), spectrum, Interpolation::bilinear};
}

SurfaceDescription read_flakes(TableReader& surface) {
  FlakesSurface flakes;
  surface.read("resolution", flakes.resolution, resolutions);
  surface.read("flake_size", flakes.flake_size_texels, closed(1, flakes.resolution / 4.0));
  surface.read("alpha", flakes.alpha, closed(0, 2));
  surface.read("seed", flakes.seed);
  return {surface.name(), flakes, Interpolation::nearest};
}

using SurfaceReader = SurfaceDescription (*)(TableReader&);

/// The reader of the surface's kind, null with a report when the kind is not clear.
SurfaceReader choose_reader(TableReader& surface) {
  if (surface.has("file") == surface.has("generate")) {
    const char* found = surface.has("file") ? "both" : "neither";
    surface.report(fmt::format("found {} of \"file\" and \"generate\"; expected exactly one", found));
    return nullptr;
  }
  SurfaceReader reader = surface.has("file") ? read_map_file : nullptr;
  surface.read("generate", reader, {{"spectrum", read_spectrum}, {"flakes", read_flakes}});
  return reader;
}

}  // namespace

std::vector<SurfaceDescription> read_surfaces(TableReader& job) {
  std::vector<SurfaceDescription> surfaces;
  job.read_named_tables("surface", [&](TableReader& surface) {
    if (const SurfaceReader read = choose_reader(surface)) {
      surfaces.push_back(read(surface));
      surface.read("interpolation", surfaces.back().interpolation, interpolations);
    } else {
      surface.accept_any_key();
      surfaces.push_back({surface.name(), MapFile{}, Interpolation::bilinear});  // materials may refer to it
    }
  });
  return surfaces;
}

}  // namespace mica
