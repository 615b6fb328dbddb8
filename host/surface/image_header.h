#pragma once

#include <cstdint>
#include <string>

namespace mica::host {

/// Which reader a file needs, told by its first bytes: names are those of OpenImageIO's plug-ins.
struct ImageFileFormat {
  std::string reader;            ///< "openexr", "png" or "tiff"
  std::uintmax_t file_size = 0;  ///< bytes
};

/// Looks at a file without handing it to any image library.
/// Throws FileError: missing, unreadable, not a regular file, empty, or none of EXR, PNG and TIFF; for EXR
/// also a header that is damaged or declares an image beyond the limits of check_declared_size.
ImageFileFormat identify_image(const std::string& path);

/// Throws FileError when an image is larger than a map may be (16384 x 16384, 64 channels) or than any
/// compression could have put into `file_size` bytes.
void check_declared_size(const std::string& path, std::uintmax_t file_size, std::int64_t width,
                         std::int64_t height, std::int64_t channels, std::int64_t bytes_a_channel);

}  // namespace mica::host
