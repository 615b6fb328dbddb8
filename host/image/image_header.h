#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "host/image/picture.h"

namespace mica::host {

/// Which reader a file needs, told by its first bytes (TGA, which has none, by its name).
struct ImageFileFormat {
  std::string reader;            ///< OpenImageIO's name of its plug-in
  std::uintmax_t file_size = 0;  ///< bytes
  std::string first_bytes;       ///< the first 32 at most
};

/// Looks at a file without handing it to any image library. Throws FileError: missing, unreadable, not a
/// regular file, empty, or no image.
ImageFileFormat identify_image(const std::string& path);

/// What a header says of one picture.
struct DeclaredPixels {
  std::int64_t width = 0, height = 0, channels = 0;
  std::int64_t bytes_a_channel = 1;
  std::int64_t tile_width = 0, tile_height = 0;  ///< 0: no tiles
  std::string compression = {};                  ///< as OpenImageIO names it
};

/// Throws FileError when a picture is larger than one may be (a map 16384, a colour 65536 pixels a side; 1024
/// channels), than its codec could have put into the file's bytes, or than `max_bytes` (0: half of the
/// machine's memory) for its pixels, whole tiles, and three floats of each.
void check_declared(const std::string& path, const ImageFileFormat& format, const DeclaredPixels& declared,
                    PictureUse use, std::uint64_t max_bytes);

/// Every part of an OpenEXR file: OpenEXR allocates line and tile buffers by their headers as soon as it
/// opens one. Throws FileError as check_declared, and for a damaged header.
void check_exr_headers(const std::string& path, const ImageFileFormat& format, PictureUse use,
                       std::uint64_t max_bytes);

/// What the pixels of a Radiance file have been multiplied with: the product of its EXPOSURE and COLORCORR
/// lines. Throws FileError: a value that is no positive number, pixels that are not RGB, primaries that are
/// not sRGB's.
std::array<double, 3> radiance_exposure(const std::string& path);

}  // namespace mica::host
