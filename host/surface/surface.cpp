#include "host/surface/surface.h"

#include <fmt/format.h>

#include <utility>

#include "host/surface/map_file.h"
#include "host/surface/synthesis.h"
#include "mica/error.h"

namespace mica::host {
namespace {

/// Makes a surface of whichever source the description holds.
class SurfaceMaker {
 public:
  SurfaceMaker(Interpolation interpolation, SurfaceReport& report)
      : interpolation_(interpolation), report_(report) {}

  Surface operator()(const MapFile& file) const { return load_map(file, interpolation_, report_); }

  Surface operator()(const SpectrumSurface& spectrum) const {
    return square(spectrum.resolution, synthesise_spectrum(spectrum, report_));
  }

  Surface operator()(const FlakesSurface& flakes) const {
    return square(flakes.resolution, synthesise_flakes(flakes, report_).texel_normals());
  }

  Surface operator()(const BrushedSurface& brushed) const {
    return square(brushed.resolution, synthesise_brushed(brushed, report_));
  }

  Surface operator()(const ScratchesSurface& scratches) const {
    return square(scratches.resolution, synthesise_scratches(scratches, report_));
  }

  Surface operator()(const DentsSurface& dents) const {
    return square(dents.resolution, synthesise_dents(dents, report_));
  }

  Surface operator()(const BumpsSurface& bumps) const {
    return square(bumps.resolution, synthesise_bumps(bumps, report_));
  }

  Surface operator()(const WavesSurface& waves) const {
    return square(waves.resolution, synthesise_waves(waves, report_));
  }

  Surface operator()(const LayersSurface& layers) const {
    return synthesise_layers(layers, interpolation_, report_);
  }

 private:
  Surface square(int resolution, std::vector<Eigen::Vector2d> normals) const {
    return Surface(resolution, resolution, interpolation_, std::move(normals));
  }

  Interpolation interpolation_;
  SurfaceReport& report_;
};

}  // namespace

Surface::Surface(int width, int height, Interpolation interpolation, std::vector<Eigen::Vector2d> normals)
    : width_(width), height_(height), interpolation_(interpolation), normals_(std::move(normals)) {
  if (width < 1 || height < 1 || normals_.size() != static_cast<std::size_t>(width) * height) {
    throw UsageError(
        fmt::format("a surface of {} x {} texels was given {} normals", width, height, normals_.size()));
  }
  for (std::size_t index = 0; index < normals_.size(); ++index) {
    if (!(normals_[index].squaredNorm() < 1)) {  // also catches NaN
      throw UsageError(fmt::format("the normal ({}, {}) of texel ({}, {}) is not inside the unit disk",
                                   normals_[index].x(), normals_[index].y(), index % width, index / width));
    }
  }
}

Surface make_surface(const SurfaceDescription& description, SurfaceReport* report) {
  SurfaceReport unread;
  return std::visit(SurfaceMaker(description.interpolation, report ? *report : unread), description.source);
}

}  // namespace mica::host
