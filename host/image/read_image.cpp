#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <system_error>

#include "host/image/image.h"
#include "mica/error.h"

namespace mica::host {
namespace {

std::uintmax_t file_size(const std::string& path) {
  std::error_code error;
  const bool regular = std::filesystem::is_regular_file(path, error);
  if (error) throw FileError(fmt::format("{}: cannot read: {}", path, error.message()));
  if (!regular) throw FileError(fmt::format("{}: cannot read: not a regular file", path));
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) throw FileError(fmt::format("{}: cannot read: {}", path, error.message()));
  if (size == 0) throw FileError(fmt::format("{}: cannot read: the file is empty", path));
  return size;
}

/// Opens by the file name's extension alone: OpenImageIO would otherwise show the file to every decoder it
/// has.
std::unique_ptr<OIIO::ImageInput> open(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  static constexpr const char* known[] = {".exr", ".hdr", ".png", ".tif", ".tiff", ".jpg", ".jpeg"};
  if (std::find(std::begin(known), std::end(known), extension) == std::end(known))
    throw FileError(fmt::format("{}: expected an image named .exr, .hdr, .png, .tif or .jpg", path));
  auto input = OIIO::ImageInput::create(extension.substr(1));
  if (!input) throw FileError(fmt::format("{}: cannot read: {}", path, OIIO::geterror()));
  OIIO::ImageSpec spec;
  if (!input->open(path, spec)) throw FileError(fmt::format("{}: cannot read: {}", path, input->geterror()));
  return input;
}

/// Refuses headers whose pixels the file cannot hold, before anything of their size is allocated.
void check_header(const std::string& path, const OIIO::ImageSpec& spec, std::uintmax_t bytes) {
  constexpr int max_side = 1 << 16, max_channels = 1024;
  // Deflate, the strongest of the codecs, cannot gain more than 1032:1; small constant images need no
  // suspicion.
  constexpr double max_ratio = 1100, unsuspected_bytes = 64 << 20;
  if (spec.width < 1 || spec.height < 1 || spec.nchannels < 1 || spec.depth > 1 || spec.deep)
    throw FileError(fmt::format("{}: expected a flat image, found {} x {} x {} pixels with {} channels", path,
                                spec.width, spec.height, spec.depth, spec.nchannels));
  if (spec.width > max_side || spec.height > max_side || spec.nchannels > max_channels)
    throw FileError(fmt::format("{}: {} x {} pixels with {} channels exceed {} x {} with {}", path,
                                spec.width, spec.height, spec.nchannels, max_side, max_side, max_channels));
  const double needed = static_cast<double>(spec.image_bytes(true));
  if (needed > unsuspected_bytes && needed > max_ratio * static_cast<double>(bytes))
    throw FileError(fmt::format(
        "{}: damaged: the header claims {} x {} pixels with {} channels, but the file has {} bytes", path,
        spec.width, spec.height, spec.nchannels, bytes));
}

/// IEC 61966-2-1.
float linear_from_srgb(float value) {
  return value <= 0.04045f ? value / 12.92f : std::pow((value + 0.055f) / 1.055f, 2.4f);
}

void check_finite(const std::string& path, const Image& image) {
  const auto bad =
      std::find_if(image.pixels.begin(), image.pixels.end(), [](float x) { return !std::isfinite(x); });
  if (bad == image.pixels.end()) return;
  const std::size_t pixel = static_cast<std::size_t>(bad - image.pixels.begin()) / image.channels.size();
  const std::size_t width = static_cast<std::size_t>(image.width);
  throw FileError(fmt::format("{}: pixel ({}, {}) from the top left is {}, expected finite values", path,
                              pixel % width, pixel / width, *bad));
}

}  // namespace

Image read_rgb(const std::string& path) {
  const std::uintmax_t bytes = file_size(path);
  const auto input = open(path);
  const OIIO::ImageSpec& spec = input->spec();
  check_header(path, spec, bytes);

  const int read_channels = spec.nchannels < 3 ? 1 : 3;
  Image image{spec.width, spec.height, {"R", "G", "B"}, {}, {}};
  const std::size_t pixel_count =
      static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height);
  image.pixels.resize(3 * pixel_count);
  if (!input->read_image(0, 0, 0, read_channels, OIIO::TypeFloat, image.pixels.data(), 3 * sizeof(float)))
    throw FileError(fmt::format("{}: cannot read: {}", path, input->geterror()));

  if (read_channels == 1)
    for (std::size_t pixel = 0; pixel < pixel_count; ++pixel)
      std::fill_n(&image.pixels[3 * pixel + 1], 2, image.pixels[3 * pixel]);
  if (!spec.format.is_floating_point())
    std::transform(image.pixels.begin(), image.pixels.end(), image.pixels.begin(), linear_from_srgb);
  check_finite(path, image);
  return image;
}

}  // namespace mica::host
