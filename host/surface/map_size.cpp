#include "host/surface/map_size.h"

#include "host/image/picture.h"

namespace mica::host {
namespace {

MapSize size_of(const MapFile& file) {
  const PictureSize size = picture_size(file.path, file.choice, PictureUse::map);
  return {size.width, size.height};
}
MapSize size_of(const LayersSurface& layers) {
  return map_size(layers.layers.at(0).surface);
}
/// Every other kind is square.
template <typename Synthesised>
MapSize size_of(const Synthesised& surface) {
  return {surface.resolution, surface.resolution};
}

}  // namespace

MapSize map_size(const SurfaceDescription& description) {
  return std::visit([](const auto& source) { return size_of(source); }, description.source);
}

}  // namespace mica::host
