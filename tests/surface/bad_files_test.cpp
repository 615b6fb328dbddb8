#include <functional>

#include "host/surface/map_pixels.h"
#include "tests/surface/map_images.h"

namespace mica::host::test::bad_files_test {
namespace {

/// Files that are no maps: each must be a FileError that begins with the path and says why.
class BadFiles : public MapImages {
 protected:
  static void expect_refused(const std::string& path, const std::string& why) {
    SCOPED_TRACE(path);
    SurfaceReport report;
    const std::string message = message_of<FileError>([&] { read_map_pixels(path, report); });
    EXPECT_EQ(message.rfind(path + ": ", 0), 0u) << message;
    EXPECT_NE(message.find(why), std::string::npos) << message;
  }

  /// An image that does not compress well.
  std::string noise(const std::string& name) const {
    std::vector<std::uint16_t> pixels;
    for (std::uint32_t i = 0, x = 1; i < 64 * 64 * 3; ++i) {
      x = x * 1664525 + 1013904223;
      pixels.push_back(static_cast<std::uint16_t>(x >> 16));
    }
    if (name.find(".exr") == std::string::npos) return write(name, 64, 64, 3, pixels);
    return write(name, 64, 64, 3, std::vector<float>(pixels.begin(), pixels.end()));
  }

  /// A copy of a file with some bytes replaced.
  std::string patched(const std::string& name, std::string bytes, std::size_t at,
                      const std::string& patch) const {
    EXPECT_LE(at + patch.size(), bytes.size());
    return write_bytes(name, bytes.replace(at, patch.size(), patch));
  }
};

std::string little_endian(std::uint32_t number) {
  std::string bytes;
  for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<char>(number >> shift));
  return bytes;
}

std::string big_endian(std::uint32_t number) {
  const std::string reversed = little_endian(number);
  return {reversed.rbegin(), reversed.rend()};
}

/// The checksum of a PNG chunk [ISO 15948, annex D], so that only the size is wrong.
std::uint32_t crc(const std::string& bytes) {
  std::uint32_t remainder = 0xffffffffu;
  for (const char byte : bytes) {
    remainder ^= static_cast<unsigned char>(byte);
    for (int bit = 0; bit < 8; ++bit) remainder = remainder >> 1 ^ (remainder & 1 ? 0xedb88320u : 0);
  }
  return ~remainder;
}

TEST_F(BadFiles, Missing) {
  expect_refused(path("nothing.exr"), "No such file");
}

TEST_F(BadFiles, PathThroughAFile) {
  const std::string file = write_bytes("file", "x");
  expect_refused(file + "/map.exr", "");
}

TEST_F(BadFiles, Directory) {
  std::filesystem::create_directories(path("folder.exr"));
  expect_refused(path("folder.exr"), "is a directory");
}

TEST_F(BadFiles, NotARegularFile) {
  expect_refused("/dev/zero", "not a regular file");
}

TEST_F(BadFiles, Empty) {
  for (const std::string name : {"a.exr", "a.png", "a.tif"}) expect_refused(write_bytes(name, ""), "empty");
}

TEST_F(BadFiles, NotAnImage) {
  for (const std::string name : {"a.exr", "a.png", "a.tif"}) {
    expect_refused(write_bytes(name, "x"), "not an image that Mica knows");
    expect_refused(write_bytes(name, "[image]\nwidth = 1280\n"), "not an image that Mica knows");
    expect_refused(write_bytes(name, std::string(10000, '\0')), "not an image that Mica knows");
  }
}

TEST_F(BadFiles, ContentsDecideNotTheName) {
  const std::string bytes = read_bytes(noise("a.png"));
  SurfaceReport report;
  EXPECT_EQ(read_map_pixels(write_bytes("a.exr", bytes), report).width, 64);
}

TEST_F(BadFiles, Truncated) {
  for (const std::string name : {"a.exr", "a.png", "a.tif"}) {
    const std::string bytes = read_bytes(noise(name));
    for (int part = 1; part < 32; ++part) {
      expect_refused(write_bytes(name, bytes.substr(0, bytes.size() * part / 32)), "");
    }
    // The last 12 bytes of a PNG file only say that it ends; its pixels are whole without them.
    if (name != "a.png") expect_refused(write_bytes(name, bytes.substr(0, bytes.size() - 1)), "");
    for (const std::size_t length : {4, 8, 9, 16, 24, 40})
      expect_refused(write_bytes(name, bytes.substr(0, length)), "");
  }
}

TEST_F(BadFiles, HugeExrHeader) {
  const std::string bytes = read_bytes(noise("a.exr"));
  const std::string name_and_type = std::string("dataWindow\0box2i\0", 17);
  const std::size_t greatest_x = bytes.find(name_and_type) + name_and_type.size() + 4 + 8;
  const auto with_size = [&](std::uint32_t width, std::uint32_t height) {
    return patched("huge.exr", bytes, greatest_x, little_endian(width - 1) + little_endian(height - 1));
  };
  expect_refused(with_size(1000000000, 1000000000), "declares 1000000000 x 1000000000 pixels");
  expect_refused(with_size(1u << 31, 1), "declares 2147483648 x 1 pixels");
  expect_refused(with_size(16384, 16384), "but the file has only");
  expect_refused(with_size(16385, 1), "a map has at most");
  expect_refused(with_size(0, 64), "declares 0 x 64 pixels");
}

TEST_F(BadFiles, HugePngHeader) {
  const std::string bytes = read_bytes(noise("a.png"));
  const auto with_size = [&](std::uint32_t width, std::uint32_t height) {
    std::string chunk = bytes.substr(12, 17);  // "IHDR" and its 13 bytes
    chunk.replace(4, 8, big_endian(width) + big_endian(height));
    return patched("huge.png", bytes, 12, chunk + big_endian(crc(chunk)));
  };
  SurfaceReport report;
  EXPECT_EQ(read_map_pixels(with_size(64, 64), report).width, 64);  // the patch itself does no harm
  expect_refused(with_size(900000, 900000), "declares 900000 x 900000 pixels");
  expect_refused(with_size(16384, 16384), "but the file has only");
  expect_refused(with_size(0x7fffffff, 0x7fffffff), "");
  expect_refused(with_size(64, 65), "");
}

TEST_F(BadFiles, HugeTiffHeader) {
  // A directory of width, height, bits, compression, photometric, offset, rows a strip, bytes of a strip.
  const auto with_size = [&](std::uint32_t width, std::uint32_t height) {
    const std::uint32_t entries[][2] = {{256, width}, {257, height}, {258, 8},      {259, 1},
                                        {262, 1},     {273, 8},      {278, height}, {279, 100}};
    std::string bytes = std::string("II\x2a\0", 4) + little_endian(8) + std::string("\x08\0", 2);
    for (const auto& [tag, number] : entries) {
      bytes += little_endian(tag | 4u << 16) + little_endian(1) + little_endian(number);  // 4: a long
    }
    return write_bytes("huge.tif", bytes + little_endian(0) + std::string(100, '\x7f'));
  };
  SurfaceReport report;
  EXPECT_EQ(read_map_pixels(with_size(10, 10), report).width, 10);
  expect_refused(with_size(60000, 60000), "declares 60000 x 60000 pixels");
  expect_refused(with_size(16384, 16384), "but the file has only");
  expect_refused(with_size(1000000000, 1000000000), "");  // OpenImageIO has a limit of its own
}

TEST_F(BadFiles, ManyChannels) {
  const auto name_channels = [](OIIO::ImageSpec& spec) {
    spec.channelnames.clear();
    for (int channel = 0; channel < 1025; ++channel)
      spec.channelnames.push_back("c" + std::to_string(channel));
  };
  expect_refused(write("a.exr", 1, 1, 1025, std::vector<float>(1025), name_channels), "a map has at most");
}

TEST_F(BadFiles, DamagedExrHeader) {
  const std::string bytes = read_bytes(noise("a.exr"));
  const std::size_t size_of_channels = bytes.find(std::string("channels\0chlist\0", 16)) + 16;
  expect_refused(patched("b.exr", bytes, size_of_channels, little_endian(0xffffffffu)), "damaged");
  expect_refused(patched("b.exr", bytes, size_of_channels, little_endian(0x7fffffffu)), "damaged");
  expect_refused(write_bytes("b.exr", bytes.substr(0, 8) + std::string(1000, 'x')), "damaged");
}

}  // namespace
}  // namespace mica::host::test::bad_files_test
