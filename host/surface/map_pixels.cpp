#include "host/surface/map_pixels.h"

#include <algorithm>
#include <utility>

namespace mica::host {

MapPixels read_map_pixels(const std::string& path, SurfaceReport& report, const PictureChoice& choice) {
  MapPixels map{read_picture(path, choice, PictureUse::map, &report)};
  const auto stride =
      static_cast<std::ptrdiff_t>(map.width) * static_cast<std::ptrdiff_t>(map.channels.size());
  for (std::ptrdiff_t top = 0, bottom = map.height - 1; top < bottom; ++top, --bottom)
    std::swap_ranges(map.pixels.begin() + top * stride, map.pixels.begin() + (top + 1) * stride,
                     map.pixels.begin() + bottom * stride);
  return map;
}

}  // namespace mica::host
