#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host/base/findings.h"
#include "host/base/words.h"

namespace mica::host {

/// Which of the pictures in a file is meant, and what it may cost.
struct PictureChoice {
  std::string part =
      {};  ///< name or number from 0 of an EXR's part or a TIFF's page; empty: the one that fits
  std::string channels = {};    ///< a layer ("N" of N.X, N.Y, N.Z) or names ("A,G"); empty: those that fit
  std::uint64_t max_bytes = 0;  ///< that reading may allocate; 0: half of the machine's memory
};

/// What to do with pixels that cannot be: NaN, infinite, of zero length in a map, negative in a light.
enum class TexelRepair { repair, refuse };

template <>
struct Words<TexelRepair> {
  static constexpr Word<TexelRepair> all[] = {{"repair", TexelRepair::repair},
                                              {"refuse", TexelRepair::refuse}};
};

/// Normals and heights are numbers as stored; colours and radiance have a curve and primaries.
enum class PictureUse { map, color };

/// Pixels of a file, its conventions honoured: rows from the top of what a viewer shows, the display window,
/// colour that alpha has not been multiplied into (integers), radiance that exposure has been divided out of.
/// No transfer curve is undone.
struct Picture {
  enum class Type { unsigned_integer, signed_integer, floating };

  int width = 0, height = 0;
  std::vector<std::string>
      channels;  ///< names as stored: 3, 2 or 1 for maps; R, G, B or a single grey for colours
  Type type = Type::floating;
  int bits = 32;              ///< a channel
  std::string format;         ///< OpenImageIO's name: "openexr", "jpeg", ...
  bool is_lossy = false;      ///< a codec that gives other pixels than it was given
  double gamma = 0;           ///< that the file says its integers have; 0: unsaid
  std::vector<float> pixels;  ///< interleaved; unsigned integers scaled to [0, 1], signed ones to [-1, 1]
};

/// Reads an image of any format that OpenImageIO knows; the table in docs/files.md says what becomes of what
/// a format can say. What was chosen and left out is noted. Throws FileError: no regular file, not an image,
/// damaged or truncated, larger than its bytes can hold or than `choice.max_bytes`, with conventions that are
/// not honoured, or without channels that fit.
Picture read_picture(const std::string& path, const PictureChoice& choice, PictureUse use,
                     Findings* findings);

struct PictureSize {
  int width = 0, height = 0;
};
/// Size of what read_picture would give, from the header alone. Throws FileError.
PictureSize picture_size(const std::string& path, const PictureChoice& choice, PictureUse use);

}  // namespace mica::host
