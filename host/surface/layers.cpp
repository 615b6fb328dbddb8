#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "host/surface/disk.h"
#include "host/surface/settings.h"
#include "host/surface/synthesis.h"
#include "mica/error.h"

namespace mica::host {

Surface synthesise_layers(const LayersSurface& description, Interpolation interpolation,
                          SurfaceReport& report) {
  if (description.layers.empty()) throw UsageError("layers: found none, expected at least one");
  int width = 0, height = 0;
  std::vector<Eigen::Vector2d> texels;
  for (const SurfaceLayer& layer : description.layers) {
    synthesis::check_setting("layers", "weight", layer.weight, -100, 100);
    const Surface surface = make_surface(layer.surface, &report);
    if (texels.empty()) {
      width = surface.width(), height = surface.height();
      texels.assign(surface.normals().size(), Eigen::Vector2d::Zero());
    }
    if (surface.width() != width || surface.height() != height) {
      throw UsageError(fmt::format("layers: \"{}\" has {} x {} texels, expected {} x {} as \"{}\" has",
                                   layer.surface.name, surface.width(), surface.height(), width, height,
                                   description.layers[0].surface.name));
    }
    tbb::parallel_for(std::size_t{0}, texels.size(), [&](std::size_t texel) {
      texels[texel] += layer.weight * slope_from_disk(surface.normals()[texel]);
    });
  }
  tbb::parallel_for(std::size_t{0}, texels.size(),
                    [&](std::size_t texel) { texels[texel] = disk_from_slope(texels[texel]); });
  return Surface(width, height, interpolation, std::move(texels));
}

}  // namespace mica::host
