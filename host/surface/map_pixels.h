#pragma once

#include <string>
#include <vector>

#include "host/surface/surface.h"

namespace mica::host {

/// The pixels of a map file as they are stored: no colour conversion, no division by alpha.
struct MapPixels {
  enum class Type { unsigned_integer, signed_integer, floating };

  int width = 0, height = 0;
  int channels = 0;  ///< 1 to 3, alpha left out
  Type type = Type::floating;
  int bits = 32;  ///< a channel
  /// Interleaved; unsigned integers scaled to [0, 1], signed ones to [-1, 1]. The image's *bottom* row comes
  /// first.
  std::vector<float> values;

  float value(std::size_t texel, int channel) const { return values[texel * channels + channel]; }
};

/// Reads the first image of an EXR, PNG or TIFF file. Sizes are checked against the file's before anything is
/// allocated: at most 16384 x 16384 pixels, and no more bytes than the file can hold at the best compression.
/// Channels and properties of the file that are not used are noted in the report.
/// Throws FileError: missing, not a regular file, empty, not an image of these formats, damaged, truncated,
/// too large.
MapPixels read_map_pixels(const std::string& path, SurfaceReport& report);

}  // namespace mica::host
