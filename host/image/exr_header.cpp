#include <array>
#include <cstdint>
#include <fstream>
#include <string>

#include "host/image/image_header.h"
#include "mica/error.h"

namespace mica::host {
namespace {

/// Reads the attributes of OpenEXR headers, enough of them to know the size of what they declare.
class ExrHeaders {
 public:
  ExrHeaders(const std::string& path, const ImageFileFormat& format) : path_(path), format_(format) {
    stream_.open(path, std::ios::binary);
    stream_.seekg(4);  // magic number
  }

  void check(PictureUse use, std::uint64_t max_bytes) {
    const bool has_parts = (integer() & 0x1000) != 0;
    for (std::string name = text(); !name.empty(); name = has_parts ? text() : std::string()) {
      read_header(std::move(name));
      check_declared(path_, format_, declared_, use, max_bytes);
    }
  }

 private:
  [[noreturn]] void damaged() const {
    throw FileError(path_ + ": the OpenEXR header is damaged or truncated");
  }

  /// One part, from the name of its first attribute on.
  void read_header(std::string name) {
    declared_ = {};
    declared_.bytes_a_channel = 2;                     // half floats are the smallest pixels
    std::array<std::int64_t, 4> window{0, 0, -1, -1};  // least x, least y, greatest x, greatest y
    for (; !name.empty(); name = text()) {
      const std::string type = text();
      const std::int32_t size = integer();
      const std::streamoff begin = stream_.tellg();
      if (size < 0 ||
          static_cast<std::uintmax_t>(begin) + static_cast<std::uintmax_t>(size) > format_.file_size)
        damaged();
      if (type == "box2i" && name == "dataWindow") {
        for (std::int64_t& bound : window) bound = integer();
      } else if (type == "chlist") {
        declared_.channels = count_channels();
      } else if (type == "tiledesc") {
        declared_.tile_width = static_cast<std::uint32_t>(integer());
        declared_.tile_height = static_cast<std::uint32_t>(integer());
      } else if (type == "compression") {
        constexpr const char* names[] = {"none", "rle", "zips", "zip", "piz", "pxr24", "b44", "b44a"};
        const auto code = static_cast<unsigned char>(byte());
        if (code < std::size(names)) declared_.compression = names[code];
      }
      stream_.seekg(begin + size);
    }
    declared_.width = window[2] - window[0] + 1, declared_.height = window[3] - window[1] + 1;
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
    const int bytes_after_name = 16;    // type, linearity, sampling
    const std::int64_t most = 1 << 16;  // far above what is refused
    std::int64_t count = 0;
    for (std::string name = text(); !name.empty() && count <= most; name = text()) {
      stream_.seekg(bytes_after_name, std::ios::cur);
      ++count;
    }
    return count;
  }

  std::string path_;
  const ImageFileFormat& format_;
  std::ifstream stream_;
  DeclaredPixels declared_;
};

}  // namespace

void check_exr_headers(const std::string& path, const ImageFileFormat& format, PictureUse use,
                       std::uint64_t max_bytes) {
  ExrHeaders(path, format).check(use, max_bytes);
}

}  // namespace mica::host
