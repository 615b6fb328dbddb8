#include <array>
#include <cstdint>
#include <fstream>
#include <string>

#include "host/image/image_header.h"
#include "mica/error.h"

namespace mica::host {
namespace {

/// Bytes of attributes whose type says them: OpenEXR reads so many, whatever their header has.
struct TypeSize {
  const char* type;
  std::int32_t bytes;
};
constexpr TypeSize kTypeSizes[] = {{"box2f", 16},
                                   {"box2i", 16},
                                   {"chromaticities", 32},
                                   {"compression", 1},
                                   {"deepImageState", 1},
                                   {"double", 8},
                                   {"envmap", 1},
                                   {"float", 4},
                                   {"int", 4},
                                   {"keycode", 28},
                                   {"lineOrder", 1},
                                   {"m33d", 72},
                                   {"m33f", 36},
                                   {"m44d", 128},
                                   {"m44f", 64},
                                   {"rational", 8},
                                   {"tiledesc", 9},
                                   {"timecode", 8},
                                   {"v2d", 16},
                                   {"v2f", 8},
                                   {"v2i", 8},
                                   {"v3d", 24},
                                   {"v3f", 12},
                                   {"v3i", 12}};

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
      check_size(type, size);
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

  /// OpenEXR takes memory for what the value of an attribute says, too.
  void check_size(const std::string& type, std::int32_t size) {
    for (const TypeSize& known : kTypeSizes)
      if (type == known.type && size != known.bytes) damaged();
    if (type == "chlist") {  // it is read up to an empty name
      const std::streamoff begin = stream_.tellg();
      count_channels();
      if (stream_.tellg() != begin + size) damaged();
      stream_.seekg(begin);
    }
    if (type == "preview") {
      const std::streamoff begin = stream_.tellg();
      const std::uint64_t width = static_cast<std::uint32_t>(integer()),
                          height = static_cast<std::uint32_t>(integer());
      const auto room = static_cast<std::uint64_t>(size);
      if (width * height > room || room != 8 + 4 * width * height) damaged();
      stream_.seekg(begin);
    }
    if (type == "stringvector") {
      const std::streamoff begin = stream_.tellg();
      for (std::int32_t left = size; left > 0;) {
        const std::int32_t length = integer();
        left -= 4;
        if (length < 0 || length > left) damaged();
        stream_.seekg(length, std::ios::cur);
        left -= length;
      }
      stream_.seekg(begin);
    }
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
