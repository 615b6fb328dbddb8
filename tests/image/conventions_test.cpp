// What few files say of their pixels, byte by byte: each is honoured or refused, as the table in
// docs/files.md has it.
#include <OpenImageIO/deepdata.h>
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "host/image/image.h"
#include "tests/image/picture_folder.h"

namespace mica::host::conventions_test {
namespace {

using OIIO::ImageSpec;
using Floats = std::vector<float>;

std::string from_hex(const std::string& hex) {
  std::string bytes;
  for (std::size_t n = 0; n + 1 < hex.size(); n += 2)
    bytes += static_cast<char>(std::stoi(hex.substr(n, 2), nullptr, 16));
  return bytes;
}

template <typename Integer>
void put(std::string* bytes, Integer value) {
  for (std::size_t n = 0; n < sizeof value; ++n)
    *bytes += static_cast<char>(static_cast<std::uint64_t>(value) >> (8 * n));
}

/// A TIFF of one strip. @param tags number, count and value, in the order of their numbers; each of 16 bits.
struct TiffTag {
  std::uint16_t number;
  std::vector<std::uint16_t> values;
};
std::string tiff(std::uint16_t width, std::uint16_t photometric, const std::vector<std::uint16_t>& bits,
                 const std::string& pixels, const std::vector<std::uint16_t>& palette = {}) {
  const auto samples = static_cast<std::uint16_t>(bits.size());
  std::vector<TiffTag> tags = {
      {256, {width}},   {257, {1}},           {258, bits},
      {259, {1}},       {262, {photometric}}, {273, {8}},
      {277, {samples}}, {278, {1}},           {279, {static_cast<std::uint16_t>(pixels.size())}}};
  if (!palette.empty()) tags.push_back({320, palette});
  std::string bytes("II*\0", 4), directory, beyond;
  const auto directory_at = static_cast<std::uint32_t>(8 + (pixels.size() + 1) / 2 * 2);
  const auto beyond_at = static_cast<std::uint32_t>(directory_at + 2 + 12 * tags.size() + 4);
  put(&bytes, directory_at);
  bytes += pixels;
  bytes.resize(directory_at);
  put(&directory, static_cast<std::uint16_t>(tags.size()));
  for (const TiffTag& tag : tags) {
    put(&directory, tag.number), put(&directory, std::uint16_t{3});
    put(&directory, static_cast<std::uint32_t>(tag.values.size()));
    std::string values;
    for (const std::uint16_t value : tag.values) put(&values, value);
    if (values.size() > 4) {
      put(&directory, static_cast<std::uint32_t>(beyond_at + beyond.size()));
      beyond += values;
    } else {
      values.resize(4);
      directory += values;
    }
  }
  put(&directory, std::uint32_t{0});
  return bytes + directory + beyond;
}

/// A DDS of 4 x 4 pixels. @param code of its four characters. @param caps2 what kind of picture it says it
/// is.
std::string dds(const std::string& code, const std::string& blocks, std::uint32_t caps2 = 0,
                std::uint32_t depth = 0) {
  constexpr std::uint32_t described = 0x1007, is_volume = 0x800000, linear = 0x80000, has_code = 4,
                          texture = 0x1000, complex = 8;
  std::string bytes = "DDS ";
  for (const std::uint32_t word :
       {124u, described | linear | (depth ? is_volume : 0u), 4u, 4u, 16u, depth, 0u})
    put(&bytes, word);
  bytes.append(44, '\0');
  put(&bytes, 32u), put(&bytes, has_code);
  bytes += code;
  bytes.append(20, '\0');
  for (const std::uint32_t word : {texture | (caps2 ? complex : 0u), caps2, 0u, 0u, 0u}) put(&bytes, word);
  return bytes + blocks;
}

class Conventions : public PictureFolderTest {
 protected:
  std::string write_bytes(const std::string& name, const std::string& bytes) const {
    std::ofstream(path(name), std::ios::binary) << bytes;
    return path(name);
  }
  static Floats map_pixels(const std::string& file) {
    return read_picture(file, {}, PictureUse::map, nullptr).pixels;
  }
  /// In steps of 8 bits.
  static void expect_map(const std::string& file, const Floats& expected) {
    const Floats found = map_pixels(file);
    ASSERT_EQ(found.size(), expected.size()) << file;
    for (std::size_t n = 0; n < found.size(); ++n) EXPECT_NEAR(255 * found[n], expected[n], 1e-3) << file;
  }
  static void expect_refused(const std::string& file, const std::string& why) {
    for (const std::string& message :
         {error([&] { read_picture(file, {}, PictureUse::map, nullptr); }), error([&] { read_rgb(file); })})
      EXPECT_NE(message.find(why), std::string::npos) << file << ": " << message;
  }
};

TEST_F(Conventions, PalettesAreLookedUp) {
  // Two pixels, the other way round than their palette; Pillow's PNG of one bit.
  expect_map(
      write_bytes("p.png", from_hex("89504e470d0a1a0a0000000d4948445200000002000000010103000000ceecedc9000000"
                                    "06504c5445c85adc0a141e9fcb9bbd0000000a49444154789c637000000042004129"
                                    "37f4ef0000000049454e44ae426082")),
      {200, 90, 220, 10, 20, 30});
  std::vector<std::uint16_t> palette(3 * 256, 0);
  for (const auto& [index, value] : {std::pair{7, 200}, {256 + 7, 90}, {512 + 7, 220}})
    palette[static_cast<std::size_t>(index)] = static_cast<std::uint16_t>(257 * value);
  expect_map(write_bytes("p.tif", tiff(1, 3, {8}, "\7", palette)), {200, 90, 220});
}

TEST_F(Conventions, WhiteIsZeroIsTurnedOver) {
  expect_map(write_bytes("white.tif", tiff(2, 0, {8}, "\x0a\xff")), {245, 0});
  expect_map(write_bytes("black.tif", tiff(2, 1, {8}, "\x0a\xff")), {10, 255});
}

TEST_F(Conventions, BitsAChannelScaleTheirNumbers) {
  expect_map(write_bytes("four.tif", tiff(2, 1, {4}, "\xf5")), {255, 85});
  ImageSpec ten(1, 1, 3);
  ten.attribute("oiio:BitsPerSample", 10);
  const std::string file = write<std::uint16_t>("ten.tif", ten, {65535, 32800, 0});
  const Picture picture = read_picture(file, {}, PictureUse::map, nullptr);
  EXPECT_EQ(picture.bits, 10);
  EXPECT_NEAR(picture.pixels[0], 1, 1e-6);
  EXPECT_NEAR(picture.pixels[1], 32800 / 65535.0, 0.5 / 1023);
}

TEST_F(Conventions, CmykIsRefused) {
  expect_refused(write_bytes("c.tif", tiff(1, 5, {8, 8, 8, 8}, "\x0a\x14\x1e\x28")), "CMYK");
  expect_refused(  // Pillow's
      write_bytes(
          "c.jpg",
          from_hex("ffd8ffee000e41646f626500640000000000ffdb004300100b0c0e0c0a100e0d0e1211101318281a18"
                   "1616183123251d283a333d3c3933383740485c4e404457453738506d51575f626768673e4d7179"
                   "7064785c656763ffc000140800010001044311004d11005911004b1100ffc4001400010000000000"
                   "0000000000000000000006ffc40014100100000000000000000000000000000000ffda000e0443004d"
                   "0059004b00003f00766c6258ffd9")),
      "CMYK");
}

TEST_F(Conventions, ProfilesThatDoNotSaySrgbAreRefusedOfColours) {
  const auto with_profile = [&](const std::string& name, const std::string& profile) {
    ImageSpec spec(1, 1, 3);
    spec.attribute("ICCProfile", OIIO::TypeDesc(OIIO::TypeDesc::UINT8, static_cast<int>(profile.size())),
                   profile.data());
    return write<std::uint8_t>(name, spec, {200, 90, 220});
  };
  const std::string header = std::string(128, '\0') + "desc....";
  for (const std::string type : {"tif", "jpg"}) {
    const std::string other = with_profile("adobe." + type, header + "Adobe RGB (1998)");
    const std::string message = error([&] { read_rgb(other); });
    EXPECT_NE(message.find("ICC profile that does not say sRGB"), std::string::npos) << message;
    EXPECT_EQ(map_pixels(other).size(), 3u) << "numbers of a map have no colour";
    EXPECT_EQ(read_rgb(with_profile("srgb." + type, header + "sRGB IEC61966-2.1")).pixels.size(), 3u);
  }
}

TEST_F(Conventions, TwoChannelsOfBc5AreAMap) {
  // A block of one value is its two end points, then an index of three bits for each pixel.
  const auto block = [](unsigned char value) {
    return std::string{static_cast<char>(value), static_cast<char>(value)} + std::string(6, '\0');
  };
  const std::string file = write_bytes("n.dds", dds("ATI2", block(200) + block(90)));
  const Picture picture = read_picture(file, {}, PictureUse::map, nullptr);
  EXPECT_TRUE(picture.is_lossy);
  ASSERT_GE(picture.channels.size(), 2u);
  EXPECT_NEAR(255 * picture.pixels[0], 200, 1e-3);
  EXPECT_NEAR(255 * picture.pixels[1], 90, 1e-3);
  expect_map(write_bytes("h.dds", dds("ATI1", block(77))), Floats(16, 77));
}

TEST_F(Conventions, CubesAreRefused) {
  ImageSpec cube(4, 24, 3);
  cube.attribute("textureformat", "CubeFace Environment");
  cube.tile_width = cube.tile_height = 4;
  cube.full_width = 4, cube.full_height = 4;
  expect_refused(write<float>("cube.exr", cube, Floats(4 * 24 * 3, 0.5f)), "cube map");
  const std::string face(16, '\x55');
  expect_refused(write_bytes("cube.dds", dds("ATI2", face + face + face + face + face + face, 0xfe00)),
                 "cube");
}

TEST_F(Conventions, VolumesDeepPixelsAndAnimationsAreRefused) {
  expect_refused(write_bytes("v.dds", dds("DXT1", std::string(16, '\x55'), 0x200000, 2)), "volume");
  ImageSpec spec(2, 2, 3, OIIO::TypeFloat);
  spec.deep = true;
  OIIO::DeepData deep(spec);
  auto output = OIIO::ImageOutput::create(path("deep.exr"));
  ASSERT_TRUE(output->open(path("deep.exr"), spec));
  ASSERT_TRUE(output->write_deep_image(deep)) << output->geterror();
  ASSERT_TRUE(output->close());
  expect_refused(path("deep.exr"), "deep pixels");
  expect_refused(  // Pillow's, of two frames
      write_bytes("a.webp",
                  from_hex("524946468600000057454250565038580a00000002000000000000000000414e494d060000000000"
                           "00000000414e4d462a000000000000000000000000000000640000025650384c110000002f000000"
                           "000750bc2297a7ff8188e87f0000414e4d4628000000000000000000000000000000640000005650"
                           "384c0f0000002f0000000007905181fe0722a2ff0100")),
      "an animation");
}

TEST_F(Conventions, Jpeg2000IsRead) {
  std::vector<std::uint8_t> flat;
  for (int pixel = 0; pixel < 64 * 64; ++pixel) flat.insert(flat.end(), {200, 90, 220});
  const Floats found = map_pixels(write("n.jp2", ImageSpec(64, 64, 3), flat));
  ASSERT_EQ(found.size(), flat.size());
  for (std::size_t n = 0; n < 3; ++n) EXPECT_NEAR(255 * found[n], flat[n], 1.5f);
}

}  // namespace
}  // namespace mica::host::conventions_test
