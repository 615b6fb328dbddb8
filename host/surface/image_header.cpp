#include "host/surface/image_header.h"

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "mica/error.h"

namespace mica::host {
namespace {

constexpr std::int64_t kMaximumSide = 16384;
constexpr std::int64_t kMaximumChannels = 64;
/// Run lengths and entropy coders reach a few thousand on constant images.
constexpr std::uintmax_t kMaximumCompression = 20000;
/// What may be allocated on any file's word.
constexpr std::uintmax_t kHarmlessBytes = 64u << 20;

/// Reads the attributes of an OpenEXR header, enough of it to know the size of what it declares. OpenEXR
/// allocates line and tile buffers by these numbers as soon as it opens a file.
class ExrHeader {
 public:
  ExrHeader(const std::string& path, std::uintmax_t file_size) : path_(path), file_size_(file_size) {
    stream_.open(path, std::ios::binary);
    stream_.seekg(8);  // magic number, version
  }

  void check() {
    for (std::string name = text(); !name.empty(); name = text()) {
      const std::string type = text();
      const std::int32_t size = integer();
      const std::streamoff begin = stream_.tellg();
      if (size < 0 || static_cast<std::uintmax_t>(begin) + static_cast<std::uintmax_t>(size) > file_size_)
        damaged();
      if (type == "box2i" && name == "dataWindow") {
        for (std::int64_t& bound : window_) bound = integer();
      } else if (type == "chlist") {
        channels_ = count_channels();
      }
      stream_.seekg(begin + size);
    }
    const std::int64_t width = window_[2] - window_[0] + 1, height = window_[3] - window_[1] + 1;
    const std::int64_t least_bytes = 2;  // half floats are the smallest pixels
    check_declared_size(path_, file_size_, width, height, channels_, least_bytes);
  }

 private:
  [[noreturn]] void damaged() const {
    throw FileError(path_ + ": the OpenEXR header is damaged or truncated");
  }

  std::string text() {
    const std::size_t longest = 255;
    std::string result;
    for (char c = byte(); c != '\0'; c = byte()) {
      if (result.size() == longest) damaged();
      result.push_back(c);
    }
    return result;
  }

  char byte() {
    char c = 0;
    if (!stream_.get(c)) damaged();
    return c;
  }

  std::int32_t integer() {  // little-endian
    std::uint32_t bits = 0;
    for (int shift = 0; shift < 32; shift += 8)
      bits |= std::uint32_t{static_cast<unsigned char>(byte())} << shift;
    return static_cast<std::int32_t>(bits);
  }

  std::int64_t count_channels() {
    const int bytes_after_name = 16;  // type, linearity, sampling
    std::int64_t count = 0;
    for (std::string name = text(); !name.empty() && count <= kMaximumChannels; name = text()) {
      stream_.seekg(bytes_after_name, std::ios::cur);
      ++count;
    }
    return count;
  }

  std::string path_;
  std::uintmax_t file_size_;
  std::ifstream stream_;
  std::array<std::int64_t, 4> window_{0, 0, -1, -1};  // least x, least y, greatest x, greatest y
  std::int64_t channels_ = 0;
};

bool starts_with(const std::string& bytes, const char* magic, std::size_t size) {
  return bytes.compare(0, size, magic, size) == 0;
}

/// Reader by magic number; empty when the bytes are of another kind.
std::string reader_of(const std::string& first_bytes) {
  if (starts_with(first_bytes, "\x76\x2f\x31\x01", 4)) return "openexr";
  if (starts_with(first_bytes, "\x89PNG\r\n\x1a\n", 8)) return "png";
  for (const char* magic : {"II\x2a\0", "MM\0\x2a", "II\x2b\0", "MM\0\x2b"}) {
    if (starts_with(first_bytes, magic, 4)) return "tiff";
  }
  return "";
}

}  // namespace

void check_declared_size(const std::string& path, std::uintmax_t file_size, std::int64_t width,
                         std::int64_t height, std::int64_t channels, std::int64_t bytes_a_channel) {
  if (width < 1 || height < 1 || channels < 1) {
    throw FileError(fmt::format("{}: the header declares {} x {} pixels of {} channels; the file is damaged",
                                path, width, height, channels));
  }
  if (width > kMaximumSide || height > kMaximumSide || channels > kMaximumChannels) {
    throw FileError(
        fmt::format("{}: the header declares {} x {} pixels of {} channels; a map has at most {} x {} of {}",
                    path, width, height, channels, kMaximumSide, kMaximumSide, kMaximumChannels));
  }
  const auto declared = static_cast<std::uintmax_t>(width * height * channels * bytes_a_channel);
  if (declared > kHarmlessBytes && declared / kMaximumCompression > file_size) {
    throw FileError(
        fmt::format("{}: the header declares {} x {} pixels, {} bytes, but the file has only {} bytes", path,
                    width, height, declared, file_size));
  }
}

ImageFileFormat identify_image(const std::string& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) {
    const bool missing = !error || error == std::errc::no_such_file_or_directory;
    throw FileError(path + ": " + (missing ? "no such file" : error.message()));
  }
  if (std::filesystem::is_directory(status)) throw FileError(path + ": is a directory, expected an image");
  if (!std::filesystem::is_regular_file(status)) throw FileError(path + ": is not a regular file");

  ImageFileFormat format;
  format.file_size = std::filesystem::file_size(path, error);
  if (error) throw FileError(path + ": " + error.message());
  if (format.file_size == 0) throw FileError(path + ": the file is empty (0 bytes)");

  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw FileError(path + ": cannot be read: " + std::strerror(errno));
  std::string first_bytes(8, '\0');
  stream.read(first_bytes.data(), static_cast<std::streamsize>(first_bytes.size()));
  format.reader = reader_of(first_bytes);
  if (format.reader.empty()) throw FileError(path + ": is not an EXR, PNG or TIFF image");
  if (format.reader == "openexr") ExrHeader(path, format.file_size).check();
  return format;
}

}  // namespace mica::host
