#include "host/surface/map_pixels.h"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <memory>

#include "host/surface/image_header.h"
#include "mica/error.h"

namespace mica::host {
namespace {

/// What the reader said, on one line.
std::string reason(std::string message) {
  while (!message.empty() && (message.back() == '\n' || message.back() == ' ')) message.pop_back();
  std::replace(message.begin(), message.end(), '\n', ' ');
  return message.empty() ? "the file is damaged or truncated" : message;
}

std::unique_ptr<OIIO::ImageInput> open(const std::string& path, const std::string& reader) {
  std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::create(reader);
  if (!input) throw FileError(path + ": this build of OpenImageIO cannot read " + reader + " files");
  OIIO::ImageSpec as_stored;
  as_stored.attribute("oiio:RawColor", 1);
  as_stored.attribute("oiio:UnassociatedAlpha", 1);
  OIIO::ImageSpec spec;
  if (!input->open(path, spec, as_stored)) {
    throw FileError(path + ": cannot be read as an image: " + reason(input->geterror()));
  }
  return input;
}

/// The number of leading channels to use: those before alpha, at most 3.
int usable_channels(const OIIO::ImageSpec& spec) {
  const int before_alpha = spec.alpha_channel >= 0 ? spec.alpha_channel : spec.nchannels;
  return std::min(before_alpha, 3);
}

MapPixels::Type type_of(const OIIO::TypeDesc& format) {
  if (format.is_floating_point()) return MapPixels::Type::floating;
  return format.is_signed() ? MapPixels::Type::signed_integer : MapPixels::Type::unsigned_integer;
}

void note_what_is_ignored(const OIIO::ImageSpec& spec, int channels, SurfaceReport& report) {
  if (channels < spec.nchannels) {
    std::string used, ignored;
    for (int channel = 0; channel < spec.nchannels; ++channel) {
      std::string& list = channel < channels ? used : ignored;
      list += (list.empty() ? "" : ", ") + spec.channelnames[channel];
    }
    report.notes.push_back(fmt::format("channels used: {}; ignored: {}", used, ignored));
  }
  if (spec.x != spec.full_x || spec.y != spec.full_y || spec.width != spec.full_width ||
      spec.height != spec.full_height) {
    report.notes.push_back(
        fmt::format("the data window of {} x {} pixels is one period; the display window is ignored",
                    spec.width, spec.height));
  }
  if (spec.get_int_attribute("Orientation", 1) != 1) {
    report.notes.push_back("the orientation tag is ignored: the first stored row is the top");
  }
  if (spec.get_int_attribute("oiio:subimages", 1) > 1) {
    report.notes.push_back("only the first of several images in the file is used");
  }
}

void flip_rows(MapPixels& pixels) {
  const auto stride = static_cast<std::ptrdiff_t>(pixels.width) * pixels.channels;
  for (std::ptrdiff_t top = 0, bottom = pixels.height - 1; top < bottom; ++top, --bottom) {
    std::swap_ranges(pixels.values.begin() + top * stride, pixels.values.begin() + (top + 1) * stride,
                     pixels.values.begin() + bottom * stride);
  }
}

MapPixels read(const std::string& path, SurfaceReport& report) {
  const ImageFileFormat format = identify_image(path);
  const std::unique_ptr<OIIO::ImageInput> input = open(path, format.reader);
  const OIIO::ImageSpec spec = input->spec();
  check_declared_size(path, format.file_size, spec.width, spec.height, spec.nchannels,
                      static_cast<std::int64_t>(spec.format.size()));
  if (spec.depth > 1 || spec.deep)
    throw FileError(path + ": holds volume or deep pixels, expected a flat image");

  MapPixels pixels;
  pixels.width = spec.width;
  pixels.height = spec.height;
  pixels.channels = usable_channels(spec);
  pixels.type = type_of(spec.format);
  pixels.bits = spec.get_int_attribute("oiio:BitsPerSample", static_cast<int>(8 * spec.format.size()));
  if (pixels.channels == 0) throw FileError(path + ": has no channel but alpha");
  note_what_is_ignored(spec, pixels.channels, report);

  pixels.values.resize(static_cast<std::size_t>(pixels.width) * pixels.height * pixels.channels);
  // The TIFF reader returns true for strips it could not read and leaves only the message, with the thread it
  // ran on.
  input->threads(1);
  const bool is_read =
      input->read_image(0, 0, 0, pixels.channels, OIIO::TypeDesc::FLOAT, pixels.values.data());
  if (!is_read || input->has_error()) {
    throw FileError(path + ": the pixels cannot be read: " + reason(input->geterror()));
  }
  flip_rows(pixels);
  return pixels;
}

}  // namespace

MapPixels read_map_pixels(const std::string& path, SurfaceReport& report) {
  try {
    return read(path, report);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {  // comes from a library below
    throw FileError(path + ": cannot be read as an image: " + reason(error.what()));
  }
}

}  // namespace mica::host
