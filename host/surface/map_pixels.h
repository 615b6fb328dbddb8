#pragma once

#include <string>

#include "host/image/picture.h"
#include "host/surface/surface.h"

namespace mica::host {

/// The pixels of a map file as they are stored: no colour conversion. The image's *bottom* row comes first.
struct MapPixels : Picture {
  float value(std::size_t texel, int channel) const {
    return pixels[texel * channels.size() + static_cast<std::size_t>(channel)];
  }
};

/// Reads a map, see read_picture. Channels and properties of the file that are not used are noted in the
/// report. Throws FileError.
MapPixels read_map_pixels(const std::string& path, SurfaceReport& report, const PictureChoice& choice = {});

}  // namespace mica::host
