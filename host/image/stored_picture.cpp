#include "host/image/stored_picture.h"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <array>
#include <cstring>
#include <fstream>

#include "host/base/hash.h"
#include "host/image/image_header.h"
#include "mica/error.h"

namespace mica::host {
namespace {

/// The pixels of a PNG may be there and what follows them not; its last chunk is always the same.
void check_end(const std::string& path) {
  constexpr char last_chunk[] = "\0\0\0\0IEND\xae\x42\x60\x82";
  constexpr std::size_t size = sizeof last_chunk - 1;
  std::array<char, size> found{};
  std::ifstream file(path, std::ios::binary);
  file.seekg(-static_cast<std::streamoff>(size), std::ios::end);
  if (!file.read(found.data(), size) || std::memcmp(found.data(), last_chunk, size) != 0)
    throw FileError(fmt::format("{}: is cut short", path));
}

std::unique_ptr<OIIO::ImageInput> open_stored(const std::string& path) {
  const ImageFileFormat format = identify_image(path);
  if (format.reader == "openexr")
    check_exr_headers(path, format, PictureUse::color, 0);
  else if (format.reader != "png")
    throw FileError(fmt::format("{}: found a file of the format {}; expected a picture that Mica wrote", path,
                                format.reader));
  if (format.reader == "png") check_end(path);
  std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(path);
  if (!input) throw FileError(fmt::format("{}: cannot be read: {}", path, OIIO::geterror()));
  const OIIO::ImageSpec& spec = input->spec();
  check_declared(path, format, {spec.width, spec.height, spec.nchannels, std::int64_t(spec.format.size())},
                 PictureUse::color, 0);
  return input;
}

std::map<std::string, std::string> own_attributes(const OIIO::ImageSpec& spec) {
  std::map<std::string, std::string> own;
  for (const OIIO::ParamValue& attribute : spec.extra_attribs)
    if (attribute.name().string().compare(0, std::strlen(kOwnAttribute), kOwnAttribute) == 0)
      own[attribute.name().string()] = attribute.get_string();
  return own;
}

}  // namespace

Image read_stored_picture(const std::string& path) {
  const std::unique_ptr<OIIO::ImageInput> input = open_stored(path);
  const OIIO::ImageSpec& spec = input->spec();
  Image image;
  image.width = spec.width, image.height = spec.height;
  image.first_row = spec.y, image.whole_height = spec.full_height;
  image.channels = spec.channelnames;
  image.metadata = own_attributes(spec);
  const auto expected = image.metadata.find(kPixelHash);
  if (expected == image.metadata.end())
    throw FileError(
        fmt::format("{}: found no attribute {}; expected a picture that Mica wrote", path, kPixelHash));
  std::vector<unsigned char> bytes(spec.image_bytes(true));
  if (!input->read_image(0, 0, 0, -1, OIIO::TypeDesc::UNKNOWN, bytes.data()))
    throw FileError(fmt::format("{}: is damaged or cut short: {}", path, input->geterror()));
  if (hash_of_bytes(bytes.data(), bytes.size()) != expected->second)
    throw FileError(fmt::format("{}: is damaged: its pixels are not those that were written", path));
  image.metadata.erase(expected);
  image.pixels.resize(spec.image_pixels() * static_cast<std::size_t>(spec.nchannels));
  if (spec.format == OIIO::TypeFloat && bytes.size() == image.pixels.size() * sizeof(float))
    std::memcpy(image.pixels.data(), bytes.data(), bytes.size());
  else if (bytes.size() == image.pixels.size())
    for (std::size_t n = 0; n < bytes.size(); ++n) image.pixels[n] = static_cast<float>(bytes[n]) / 255;
  else
    throw FileError(fmt::format("{}: found pixels of type {}; expected a picture that Mica wrote", path,
                                spec.format.c_str()));
  return image;
}

}  // namespace mica::host
