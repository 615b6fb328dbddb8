#include "host/image/image_header.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <system_error>

#include "host/base/words.h"
#include "mica/error.h"

namespace mica::host {
namespace {

constexpr std::int64_t kMaximumMapSide = 16384, kMaximumSide = 65536, kMaximumChannels = 1024;
/// What may be allocated on any file's word.
constexpr double kHarmlessBytes = 64 << 20;

struct Magic {
  std::string_view bytes;
  std::size_t at;
  const char* reader;
};

using namespace std::string_view_literals;
constexpr Magic kMagics[] = {{"\x76\x2f\x31\x01"sv, 0, "openexr"},
                             {"\x89PNG\r\n\x1a\n"sv, 0, "png"},
                             {"II\x2a\0"sv, 0, "tiff"},
                             {"MM\0\x2a"sv, 0, "tiff"},
                             {"II\x2b\0"sv, 0, "tiff"},
                             {"MM\0\x2b"sv, 0, "tiff"},
                             {"\xff\xd8\xff"sv, 0, "jpeg"},
                             {"WEBP"sv, 8, "webp"},
                             {"DDS "sv, 0, "dds"},
                             {"#?"sv, 0, "hdr"},
                             {"\0\0\0\x0cjP  "sv, 0, "jpeg2000"},
                             {"\xff\x4f\xff\x51"sv, 0, "jpeg2000"},
                             {"BM"sv, 0, "bmp"},
                             {"P1"sv, 0, "pnm"},
                             {"P2"sv, 0, "pnm"},
                             {"P3"sv, 0, "pnm"},
                             {"P4"sv, 0, "pnm"},
                             {"P5"sv, 0, "pnm"},
                             {"P6"sv, 0, "pnm"},
                             {"Pf"sv, 0, "pnm"},
                             {"PF"sv, 0, "pnm"}};

std::string reader_of(const std::string& path, std::string_view first_bytes) {
  for (const Magic& magic : kMagics)
    if (first_bytes.size() > magic.at && first_bytes.substr(magic.at, magic.bytes.size()) == magic.bytes)
      return magic.reader;
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return extension == ".tga" ? "targa" : "";
}

/// How many bytes of pixels one byte of a file can stand for.
double greatest_compression(const std::string& reader, const std::string& compression) {
  const auto is = [&](const char* name) { return compression == name; };
  if (reader == "hdr" || reader == "bmp" || reader == "targa" || reader == "dds") return 1024;
  if (reader == "pnm") return 8;                     // a bit becomes a byte
  if (is("none")) return reader == "tiff" ? 32 : 1;  // palettes and bits become bytes
  if (is("rle") || is("packbits") || is("b44") || is("b44a")) return 256;
  if (reader == "png" || is("zip") || is("zips") || is("pxr24") || is("lzw")) return 1500;  // deflate: 1032
  return 20000;  // entropy coders reach a few thousand on constant images
}

std::uint64_t default_max_bytes() {
  const auto pages = static_cast<std::uint64_t>(std::max(sysconf(_SC_PHYS_PAGES), 1L));
  std::uint64_t bytes = pages * static_cast<std::uint64_t>(std::max(sysconf(_SC_PAGESIZE), 1L));
  std::uint64_t container = 0;  // what a container may use, where it is limited
  if (std::ifstream("/sys/fs/cgroup/memory.max") >> container) bytes = std::min(bytes, container);
  return bytes / 2;
}

std::int64_t whole_tiles(std::int64_t size, std::int64_t tile) {
  return tile > 0 ? (size + tile - 1) / tile * tile : size;
}

}  // namespace

void check_declared(const std::string& path, const ImageFileFormat& format, const DeclaredPixels& declared,
                    PictureUse use, std::uint64_t max_bytes) {
  const auto& [width, height, channels, bytes_a_channel, tile_width, tile_height, compression] = declared;
  const std::string what = fmt::format("{} x {} pixels of {} channels", width, height, channels);
  if (width < 1 || height < 1 || channels < 1)
    throw FileError(fmt::format("{}: the header declares {}; the file is damaged", path, what));
  const std::int64_t side = use == PictureUse::map ? kMaximumMapSide : kMaximumSide;
  if (width > side || height > side || channels > kMaximumChannels)
    throw FileError(fmt::format("{}: the header declares {}; {} has at most {} x {} of {}", path, what,
                                use == PictureUse::map ? "a map" : "an image", side, side, kMaximumChannels));

  const double stored = static_cast<double>(whole_tiles(width, tile_width)) *
                        static_cast<double>(whole_tiles(height, tile_height)) *
                        static_cast<double>(channels * bytes_a_channel);
  const std::string tiles =
      tile_width > 0 ? fmt::format(" in tiles of {} x {}", tile_width, tile_height) : "";
  const double greatest = greatest_compression(format.reader, compression);
  if (stored > kHarmlessBytes && stored > greatest * static_cast<double>(format.file_size))
    throw FileError(fmt::format("{}: the header declares {}{}, {:.0f} bytes, but the file has only {} bytes",
                                path, what, tiles, stored, format.file_size));
  const double needed =
      stored + 3.0 * sizeof(float) * static_cast<double>(width) * static_cast<double>(height);
  const std::uint64_t allowed = max_bytes ? max_bytes : default_max_bytes();
  if (needed > static_cast<double>(allowed))
    throw FileError(fmt::format("{}: reading {}{} takes {:.0f} bytes; allowed are {} (--max-memory)", path,
                                what, tiles, needed, allowed));
}

ImageFileFormat identify_image(const std::string& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  const auto refuse = [&](const std::string& why) { throw FileError(path + ": cannot read: " + why); };
  if (!std::filesystem::exists(status)) refuse(error ? error.message() : std::strerror(ENOENT));
  if (std::filesystem::is_directory(status)) refuse("is a directory, expected an image");
  if (!std::filesystem::is_regular_file(status)) refuse("not a regular file");

  ImageFileFormat format;
  format.file_size = std::filesystem::file_size(path, error);
  if (error) refuse(error.message());
  if (format.file_size == 0) refuse("the file is empty");

  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  if (!stream) refuse(std::strerror(errno));
  format.first_bytes.resize(32);
  stream.read(format.first_bytes.data(), static_cast<std::streamsize>(format.first_bytes.size()));
  format.first_bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(stream.gcount(), 0)));
  format.reader = reader_of(path, format.first_bytes);
  if (format.reader.empty())
    refuse("is not an image that Mica knows: EXR, HDR, PNG, TIFF (TX), JPEG, WebP, BMP, DDS, TGA, PNM");
  return format;
}

}  // namespace mica::host
