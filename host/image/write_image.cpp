#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "host/base/hash.h"
#include "host/image/image.h"
#include "mica/error.h"

namespace mica::host {
namespace {

void check(const std::string& path, const Image& image) {
  const std::size_t expected =
      static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * image.channels.size();
  if (image.width < 1 || image.height < 1 || image.channels.empty())
    throw FileError(fmt::format("{}: cannot write an empty image", path));
  if (image.pixels.size() != expected)
    throw FileError(fmt::format("{}: image of {} x {} pixels and {} channels has {} values instead of {}",
                                path, image.width, image.height, image.channels.size(), image.pixels.size(),
                                expected));
}

/// Encodes in memory, so that the file can then appear at once.
std::string encode(const std::string& path, const char* format, const OIIO::ImageSpec& spec,
                   const void* pixels) {
  std::vector<unsigned char> buffer;
  OIIO::Filesystem::IOVecOutput sink(buffer);
  const auto output = OIIO::ImageOutput::create(format, &sink);
  if (!output)
    throw FileError(fmt::format("{}: OpenImageIO cannot write {}: {}", path, format, OIIO::geterror()));
  if (!output->open(path, spec) || !output->write_image(spec.format, pixels) || !output->close())
    throw FileError(fmt::format("{}: cannot encode as {}: {}", path, format, output->geterror()));
  return std::string(buffer.begin(), buffer.end());
}

/// IEC 61966-2-1.
double srgb_from_linear(double value) {
  return value <= 0.0031308 ? 12.92 * value : 1.055 * std::pow(value, 1 / 2.4) - 0.055;
}

std::uint8_t display_value(float radiance, double scale, ToneMap tone_map) {
  const double value = radiance * scale;
  if (!(value > 0)) return 0;  // also NaN
  return static_cast<std::uint8_t>(std::lround(255 * srgb_from_linear(tone_mapped(tone_map, value))));
}

/// Indices of R, G, B, or of the only channel.
std::vector<std::size_t> display_channels(const std::string& path, const Image& image) {
  if (image.channels.size() == 1) return {0};
  std::vector<std::size_t> indices;
  for (const char* name : {"R", "G", "B"}) {
    const auto found = std::find(image.channels.begin(), image.channels.end(), name);
    if (found == image.channels.end())
      throw FileError(fmt::format("{}: a PNG needs the channels R, G, B or a single channel", path));
    indices.push_back(static_cast<std::size_t>(found - image.channels.begin()));
  }
  return indices;
}

}  // namespace

void write_exr(const std::string& path, const Image& image) {
  check(path, image);
  OIIO::ImageSpec spec(image.width, image.height, static_cast<int>(image.channels.size()), OIIO::TypeFloat);
  spec.channelnames = image.channels;
  spec.attribute("compression", "zip");
  spec.attribute("oiio:ColorSpace", "Linear");
  // OpenImageIO would write the time of day; the file shall depend on the image alone.
  spec.attribute("DateTime", "1970:01:01 00:00:00");
  spec.y = image.first_row;
  if (image.whole_height > 0) spec.full_height = image.whole_height, spec.full_y = 0;
  for (const auto& [name, value] : image.metadata) spec.attribute(name, value);
  spec.attribute(kPixelHash, hash_of_bytes(image.pixels.data(), image.pixels.size() * sizeof(float)));
  write_file_atomically(path, encode(path, "openexr", spec, image.pixels.data()));
}

namespace {

std::string png_bytes(const std::string& path, const Image& image, double exposure, ToneMap tone_map,
                      bool with_metadata) {
  check(path, image);
  const std::vector<std::size_t> channels = display_channels(path, image);
  const std::size_t pixel_count = image.pixels.size() / image.channels.size();
  const double scale = std::exp2(exposure);

  std::vector<std::uint8_t> values;
  values.reserve(pixel_count * channels.size());
  for (std::size_t pixel = 0; pixel < pixel_count; ++pixel)
    for (const std::size_t channel : channels)
      values.push_back(display_value(image.pixels[pixel * image.channels.size() + channel], scale, tone_map));

  OIIO::ImageSpec spec(image.width, image.height, static_cast<int>(channels.size()), OIIO::TypeUInt8);
  spec.attribute("oiio:ColorSpace", "sRGB");
  if (with_metadata) {
    for (const auto& [name, value] : image.metadata) spec.attribute(name, value);
    spec.attribute(kPixelHash, hash_of_bytes(values.data(), values.size()));
  }
  return encode(path, "png", spec, values.data());
}

}  // namespace

void write_png(const std::string& path, const Image& image, double exposure, ToneMap tone_map) {
  write_file_atomically(path, png_bytes(path, image, exposure, tone_map, true));
}

std::string encode_png(const Image& image, double exposure) {
  return png_bytes("a picture.png", image, exposure, ToneMap::shoulder, false);
}

std::string encode_png(int width, int height, const std::vector<std::uint8_t>& srgb) {
  OIIO::ImageSpec spec(width, height, 3, OIIO::TypeUInt8);
  spec.attribute("oiio:ColorSpace", "sRGB");
  return encode("a picture.png", "png", spec, srgb.data());
}

double displayed_value(float radiance) {
  return radiance > 0 ? tone_mapped(ToneMap::shoulder, radiance) : 0;
}

}  // namespace mica::host
