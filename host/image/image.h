#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "host/base/atomic_file.h"
#include "host/base/words.h"
#include "host/image/picture.h"

namespace mica::host {

/// Named float channels of equal size, rows from the top, and string metadata.
struct Image {
  int width = 0, height = 0;
  std::vector<std::string> channels;            ///< "R", "G", "B", "ndf.Y", ...
  std::vector<float> pixels;                    ///< interleaved: (row * width + column) * channels + channel
  std::map<std::string, std::string> metadata;  ///< names as written, e.g. "mica:device"
  int first_row = 0;                            ///< of the whole picture, where this is a part of it
  int whole_height = 0;                         ///< its height; 0: this is all of it
};

/// The attribute that holds a hash of a file's pixels; see read_stored_picture.
constexpr char kPixelHash[] = "mica:pixels";

/// Writes float32 EXR, whole or not at all (temporary file, fsync, rename); a part of a picture is the data
/// window of the whole. The same image gives the same bytes. Throws FileError.
void write_exr(const std::string& path, const Image& image);

/// How radiance becomes the brightness of a preview, channel by channel. [Reinhard02]: Erik Reinhard et al.,
/// "Photographic Tone Reproduction for Digital Images", SIGGRAPH 2002. [Narkowicz16]: Krzysztof Narkowicz,
/// "ACES Filmic Tone Mapping Curve", 2016.
enum class ToneMap {
  clamp,     ///< as it is, up to 1
  shoulder,  ///< as it is up to 0.8, then towards 1, so that glints keep their colour a little longer
  reinhard,  ///< x / (1 + x), [Reinhard02] Eq. 3
  filmic,    ///< a film's S-shaped curve: contrast in the middle, soft ends [Narkowicz16]
};

template <>
struct Words<ToneMap> {
  static constexpr Word<ToneMap> all[] = {{"clamp", ToneMap::clamp},
                                          {"shoulder", ToneMap::shoulder},
                                          {"reinhard", ToneMap::reinhard},
                                          {"filmic", ToneMap::filmic}};
};

/// The brightness of a radiance >= 0. @return [0, 1].
double tone_mapped(ToneMap tone_map, double radiance);

/// Writes R, G, B (or the only channel as grey) as an 8-bit sRGB PNG after 2^exposure scaling, with the
/// image's metadata as text. NaN is shown black. Throws FileError.
void write_png(const std::string& path, const Image& image, double exposure,
               ToneMap tone_map = ToneMap::shoulder);

/// The bytes of the file that write_png would write. Throws FileError.
std::string encode_png(const Image& image, double exposure);

/// The bytes of an 8-bit PNG of sRGB pixels, as they are, rows from the top. Throws FileError.
std::string encode_png(int width, int height, const std::vector<std::uint8_t>& srgb);

/// Linear light in [0, 1] that a preview shows for a radiance.
double displayed_value(float radiance);

/// Reads an image as three channels R, G, B of linear light; a single channel becomes grey. Integers are
/// taken as sRGB unless the file says another gamma. Throws FileError as read_picture, and for NaN or
/// infinite pixels.
Image read_rgb(const std::string& path, const PictureChoice& choice = {}, Findings* findings = nullptr);

/// The same of light: by `repair`, infinities become the greatest half float (or the image's brightest pixel
/// above it) and what is negative 0, noted with their number. Throws FileError besides for what is left: NaN
/// always.
Image read_radiance(const std::string& path, const PictureChoice& choice, TexelRepair invalid,
                    Findings* findings);

}  // namespace mica::host
