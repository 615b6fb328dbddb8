#include "host/surface/map_size.h"

#include <OpenImageIO/imageio.h>

#include <memory>

#include "host/surface/image_header.h"
#include "mica/error.h"

namespace mica::host {
namespace {

MapSize size_of(const MapFile& file) {
  const ImageFileFormat format = identify_image(file.path);
  const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::create(format.reader);
  OIIO::ImageSpec spec;
  if (!input || !input->open(file.path, spec)) throw FileError(file.path + ": cannot be read as an image");
  check_declared_size(file.path, format.file_size, spec.width, spec.height, spec.nchannels,
                      static_cast<std::int64_t>(spec.format.size()));
  return {spec.width, spec.height};
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
