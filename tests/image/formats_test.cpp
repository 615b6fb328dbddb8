#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "host/image/image.h"
#include "tests/image/picture_folder.h"

namespace mica::host::formats_test {
namespace {

using OIIO::ImageSpec;
using Change = std::function<void(ImageSpec&)>;

/// What formats can say of their pixels: docs/files.md has the table.
class Formats : public PictureFolderTest {
 protected:
  /// An EXR of constant float channels, one part a list of names and values.
  using Part = std::vector<std::pair<std::string, float>>;
  std::string write_exr_parts(const std::string& name, const std::vector<Part>& parts) const {
    std::vector<ImageSpec> specs;
    for (const Part& part : parts) {
      ImageSpec& spec = specs.emplace_back(4, 4, static_cast<int>(part.size()), OIIO::TypeFloat);
      spec.channelnames.clear();
      for (const auto& channel : part) spec.channelnames.push_back(channel.first);
      spec.attribute("oiio:subimagename", "part" + std::to_string(specs.size() - 1));
    }
    auto output = OIIO::ImageOutput::create(path(name));
    EXPECT_TRUE(output->open(path(name), static_cast<int>(specs.size()), specs.data()));
    for (std::size_t n = 0; n < parts.size(); ++n) {
      if (n > 0) output->open(path(name), specs[n], OIIO::ImageOutput::AppendSubimage);
      std::vector<float> values;
      for (int pixel = 0; pixel < 16; ++pixel)
        for (const auto& channel : parts[n]) values.push_back(channel.second);
      EXPECT_TRUE(output->write_image(OIIO::TypeFloat, values.data()));
    }
    EXPECT_TRUE(output->close());
    return path(name);
  }

  std::string write_bytes(const std::string& name, const std::string& bytes) const {
    std::ofstream(path(name), std::ios::binary) << bytes;
    return path(name);
  }

  static std::vector<float> first_pixel(const Picture& picture) {
    return {picture.pixels.begin(), picture.pixels.begin() + static_cast<long>(picture.channels.size())};
  }
  static std::vector<float> first_map_pixel(const std::string& file, const PictureChoice& choice = {}) {
    return first_pixel(read_picture(file, choice, PictureUse::map, nullptr));
  }
  static std::vector<float> first_rgb(const std::string& file, const PictureChoice& choice = {}) {
    const Image image = read_rgb(file, choice);
    return {image.pixels.begin(), image.pixels.begin() + 3};
  }
  static std::string map_error(const std::string& file, const PictureChoice& choice = {}) {
    return error([&] { read_picture(file, choice, PictureUse::map, nullptr); });
  }
  static std::string rgb_error(const std::string& file, const PictureChoice& choice = {}) {
    return error([&] { read_rgb(file, choice); });
  }
  static bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  }
};

TEST_F(Formats, OneMapInEveryFormat) {
  std::vector<std::uint8_t> flat;
  for (int pixel = 0; pixel < 64; ++pixel) flat.insert(flat.end(), {200, 90, 220});
  for (const std::string type : {"png", "jpg", "tga", "webp", "bmp", "tif", "ppm"}) {
    ImageSpec spec(8, 8, 3);
    spec.attribute("Compression", type == "webp" ? "lossless" : type == "jpg" ? "jpeg:100" : "");
    const Picture picture = read_picture(write("n." + type, spec, flat), {}, PictureUse::map, nullptr);
    EXPECT_EQ(picture.bits, 8) << type;
    EXPECT_EQ(picture.type, Picture::Type::unsigned_integer) << type;
    EXPECT_EQ(picture.is_lossy, type == "jpg") << type;
    ASSERT_EQ(picture.channels.size(), 3u) << type;
    const float tolerance = type == "jpg" ? 1.5f / 255 : 1e-6f;  // YCbCr is rounded, too
    EXPECT_NEAR(picture.pixels[0], 200 / 255.0f, tolerance) << type;
    EXPECT_NEAR(picture.pixels[1], 90 / 255.0f, tolerance) << type;
    EXPECT_NEAR(picture.pixels[2], 220 / 255.0f, tolerance) << type;
  }
}

TEST_F(Formats, MipLevelsAreNoPagesOfTheirOwn) {
  ImageSpec spec(16, 16, 3);
  spec.tile_width = spec.tile_height = 16;
  spec.attribute("textureformat", "Plain Texture");
  const std::string file = write("n.tx", spec, std::vector<std::uint8_t>(16 * 16 * 3, 51));
  EXPECT_EQ(read_picture(file, {}, PictureUse::map, nullptr).width, 16);
  EXPECT_NEAR(first_map_pixel(file)[0], 0.2f, 1e-6f);
}

TEST_F(Formats, NormalsAreFoundByTheirNames) {
  const Part normal = {{"N.X", 0.1f}, {"N.Y", 0.2f}, {"N.Z", 0.9f}}, beauty = {{"R", 5}, {"G", 6}, {"B", 7}};
  Part both = beauty, with_depth = {{"Z", 8}};
  both.insert(both.end(), normal.begin(), normal.end());
  with_depth.insert(with_depth.end(), normal.begin(), normal.end());
  const std::vector<float> expected = {0.1f, 0.2f, 0.9f};
  EXPECT_EQ(first_map_pixel(write_exr_parts("only.exr", {normal})), expected);
  EXPECT_EQ(first_map_pixel(write_exr_parts("both.exr", {both})), expected);
  EXPECT_EQ(first_map_pixel(write_exr_parts("depth.exr", {with_depth})), expected);
  EXPECT_EQ(first_map_pixel(write_exr_parts("parts.exr", {beauty, normal})), expected);
  EXPECT_EQ(first_rgb(path("both.exr")), (std::vector<float>{5, 6, 7}));
}

TEST_F(Formats, PartAndChannelsChoose) {
  const Part a = {{"R", 1}, {"G", 2}, {"B", 3}, {"A", 0.5f}}, b = {{"R", 4}, {"G", 5}, {"B", 6}};
  const std::string file = write_exr_parts("two.exr", {a, b});
  for (const std::string& message : {map_error(file), rgb_error(file)})
    EXPECT_TRUE(contains(message, "part part0: R, G, B; part part1: R, G, B")) << message;
  EXPECT_EQ(first_rgb(file, {"part1"}), (std::vector<float>{4, 5, 6}));
  EXPECT_EQ(first_rgb(file, {"0"}), (std::vector<float>{1, 2, 3}));
  EXPECT_EQ(first_map_pixel(file, {"0", "A,G"}), (std::vector<float>{0.5f, 2}));  // as DXT5nm has them
  EXPECT_EQ(first_map_pixel(file, {"1", "B,G,R"}), (std::vector<float>{6, 5, 4}));
  EXPECT_TRUE(contains(map_error(file, {"0", "N"}), "part part0: R, G, B, A"));
  EXPECT_TRUE(contains(map_error(file, {"normal"}), "in the part normal"));
  // Of several layers, the one that is named.
  const std::string layers = write_exr_parts(
      "layers.exr", {{{"a.R", 1}, {"a.G", 2}, {"a.B", 3}, {"b.R", 4}, {"b.G", 5}, {"b.B", 6}}});
  EXPECT_EQ(first_rgb(layers, {"", "b"}), (std::vector<float>{4, 5, 6}));
  EXPECT_TRUE(contains(rgb_error(layers), "a.R, a.G, a.B; b.R, b.G, b.B"));
}

TEST_F(Formats, ColoursAreRgbOrGrey) {
  EXPECT_TRUE(contains(rgb_error(write_exr_parts("yc.exr", {{{"Y", 1}, {"RY", 2}, {"BY", 3}}})), "BY, RY"));
  EXPECT_TRUE(contains(rgb_error(write_exr_parts("rg.exr", {{{"R", 1}, {"G", 2}}})), "channels R, G"));
  EXPECT_TRUE(contains(rgb_error(write_exr_parts("xyz.exr", {{{"X", 1}, {"Y", 2}, {"Z", 3}}})), "X, Y, Z"));
  EXPECT_TRUE(contains(rgb_error(write_exr_parts("z.exr", {{{"Z", 1}}})), "channels Z"));
  const std::string parts = write_exr_parts("env.exr", {{{"Z", 1}}, {{"R", 2}, {"G", 3}, {"B", 4}}});
  EXPECT_EQ(first_rgb(parts), (std::vector<float>{2, 3, 4}));
  ImageSpec ap1(1, 1, 3);
  const float primaries[] = {0.713f, 0.293f, 0.165f, 0.830f, 0.128f, 0.044f, 0.32168f, 0.33767f};
  ap1.attribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), primaries);
  EXPECT_TRUE(contains(rgb_error(write<float>("ap1.exr", ap1, {1, 1, 1})), "chromaticities (0.713"));
}

TEST_F(Formats, AlphaDoesNotChangeColours) {
  // IEC 61966-2-1: 200 / 255 -> 0.57758, 120 -> 0.18782, 60 -> 0.04519.
  const std::vector<float> expected = {0.57758f, 0.18782f, 0.04519f};
  ImageSpec unassociated(1, 1, 4), associated(1, 1, 4);
  unassociated.attribute("oiio:UnassociatedAlpha", 1);
  std::vector<std::string> files;
  for (const std::string type : {"png", "tif", "tga"})
    files.push_back(write<std::uint8_t>("a." + type, unassociated, {200, 120, 60, 80}));
  // Pillow's, lossless: OpenImageIO's own writer changes such colours.
  files.push_back(write_bytes("a.webp", std::string("RIFF\x1e\0\0\0WEBPVP8L\x11\0\0\0\x2f\x01\x40\0\x10\x07"
                                                    "\x50\xbc\x22\x97\xa7\x50\x81\x88\xe8\x7f\0\0",
                                                    38)));
  files.push_back(write<std::uint16_t>("b.tif", associated, {25700, 15420, 7710, 32768}));  // times 0.5
  for (const std::string& file : files) {
    const std::vector<float> rgb = first_rgb(file);
    // OpenImageIO rounds WebP's colours times alpha to integers: half a step, over alpha, on a slope
    // below 2.3.
    const float tolerance = file.find(".webp") != file.npos ? 2.3f * 0.5f / 80 : 2e-5f;
    for (std::size_t n = 0; n < 3; ++n) EXPECT_NEAR(rgb[n], expected[n], tolerance) << file;
  }
}

TEST_F(Formats, WindowsArePlacedOrCut) {
  ImageSpec part(2, 1, 3);
  part.x = 1, part.y = 1, part.full_width = 4, part.full_height = 2;
  const std::string crop = write<float>("crop.exr", part, {1, 2, 3, 4, 5, 6});
  const Image placed = read_rgb(crop);
  EXPECT_EQ(placed.width, 4);
  EXPECT_EQ(placed.height, 2);
  std::vector<float> expected(4 * 2 * 3, 0.0f);
  for (int n = 0; n < 6; ++n) expected[static_cast<std::size_t>(3 * 5 + n)] = static_cast<float>(n + 1);
  EXPECT_EQ(placed.pixels, expected);
  EXPECT_TRUE(contains(map_error(crop), "the data window of 2 x 1 pixels at (1, 1) is a part"));

  ImageSpec over(3, 1, 3);
  over.x = -1, over.full_width = 1, over.full_height = 1;
  EXPECT_EQ(read_rgb(write<float>("over.exr", over, {1, 2, 3, 4, 5, 6, 7, 8, 9})).pixels,
            (std::vector<float>{4, 5, 6}));
  EXPECT_EQ(read_picture(path("over.exr"), {}, PictureUse::map, nullptr).width, 1);
}

TEST_F(Formats, OrientationIsHonoured) {
  // Of 2 x 2 pixels, a b above c d, what each of the eight values of Exif shows, row by row.
  const std::array<std::string, 8> shown = {"abcd", "badc", "dcba", "cdab", "acbd", "cadb", "dbca", "bdac"};
  for (int orientation = 1; orientation <= 8; ++orientation) {
    ImageSpec spec(2, 2, 3);
    spec.attribute("Orientation", orientation);
    const std::string file = write<std::uint8_t>("o" + std::to_string(orientation) + ".tif", spec,
                                                 {51, 51, 51, 102, 102, 102, 153, 153, 153, 204, 204, 204});
    const Picture picture = read_picture(file, {}, PictureUse::map, nullptr);
    std::string found;
    for (std::size_t n = 0; n < picture.pixels.size(); n += 3)
      found += static_cast<char>('a' + std::lround(5 * picture.pixels[n]) - 1);
    EXPECT_EQ(found, shown[static_cast<std::size_t>(orientation - 1)]) << orientation;
    ImageSpec wide(2, 1, 3);
    wide.attribute("Orientation", orientation);
    const std::string row = write<std::uint8_t>("row.tif", wide, {51, 51, 51, 102, 102, 102});
    EXPECT_EQ(read_picture(row, {}, PictureUse::map, nullptr).width, orientation > 4 ? 1 : 2) << orientation;
    EXPECT_EQ(picture_size(row, {}, PictureUse::map).width, orientation > 4 ? 1 : 2) << orientation;
  }
}

std::string radiance(const std::string& lines, const std::string& format = "rgbe") {
  std::string pixels;
  for (int n = 0; n < 16; ++n) pixels += std::string("\x80\x40\x20\x80", 4);  // 0.5, 0.25, 0.125
  return "#?RADIANCE\n" + lines + "FORMAT=32-bit_rle_" + format + "\n\n-Y 4 +X 4\n" + pixels;
}

TEST_F(Formats, ExposureOfRadianceFilesIsDividedOut) {
  const auto rgb = [&](const std::string& lines) { return first_rgb(write_bytes("a.hdr", radiance(lines))); };
  EXPECT_EQ(rgb(""), (std::vector<float>{0.5f, 0.25f, 0.125f}));
  EXPECT_EQ(rgb("EXPOSURE=4\n"), (std::vector<float>{0.125f, 0.0625f, 0.03125f}));
  EXPECT_EQ(rgb("EXPOSURE=2\nEXPOSURE= 4\n"), (std::vector<float>{0.0625f, 0.03125f, 0.015625f}));
  EXPECT_EQ(rgb("COLORCORR=2 1 0.5\n"), (std::vector<float>{0.25f, 0.25f, 0.25f}));
  EXPECT_TRUE(contains(rgb_error(write_bytes("a.hdr", radiance("EXPOSURE=none\n"))), "'EXPOSURE=none'"));
  EXPECT_TRUE(contains(rgb_error(write_bytes("a.hdr", radiance("", "xyze"))), "XYZE"));
  EXPECT_TRUE(contains(
      rgb_error(write_bytes("a.hdr", radiance("PRIMARIES=.713 .293 .165 .83 .128 .044 .3217 .3377\n"))),
      "PRIMARIES"));
}

TEST_F(Formats, GammaOfIntegersIsHonoured) {
  const std::vector<std::uint8_t> grey = {51, 51, 51};
  ImageSpec linear(1, 1, 3), gamma(1, 1, 3);
  linear.attribute("oiio:ColorSpace", "Linear");
  gamma.attribute("oiio:ColorSpace", "GammaCorrected");
  gamma.attribute("oiio:Gamma", 1.8f);
  EXPECT_NEAR(first_rgb(write("linear.png", linear, grey))[0], 0.2f, 1e-4f);
  EXPECT_NEAR(first_rgb(write("gamma.png", gamma, grey))[0], std::pow(0.2f, 1.8f), 1e-4f);
  EXPECT_NEAR(first_map_pixel(path("gamma.png"))[0], 0.2f, 1e-6f);  // a map has no curve
}

TEST_F(Formats, ImpossibleLightIsRepairedOrRefused) {
  const std::string file = write<float>("sun.exr", ImageSpec(2, 1, 3), {1, -1e-6f, 3, INFINITY, 5, 6});
  Findings findings;
  EXPECT_EQ(read_radiance(file, {}, TexelRepair::repair, &findings).pixels,
            (std::vector<float>{1, 0, 3, 65504, 5, 6}));
  ASSERT_EQ(findings.notes.size(), 2u);
  EXPECT_TRUE(contains(findings.notes[0], "1 of 6 values are infinite (the first in pixel (1, 0)"));
  EXPECT_TRUE(contains(error([&] { read_radiance(file, {}, TexelRepair::refuse, nullptr); }), "is inf"));
  write<float>("nan.exr", ImageSpec(1, 1, 3), {1, NAN, 3});
  EXPECT_TRUE(
      contains(error([&] { read_radiance(path("nan.exr"), {}, TexelRepair::repair, nullptr); }), "nan"));
}

TEST_F(Formats, MemoryIsAskedForBeforeItIsTaken) {
  const std::string file = write("a.png", ImageSpec(1024, 512, 3), std::vector<std::uint8_t>(3 << 19, 9));
  // 3 bytes and 3 floats a pixel.
  EXPECT_EQ(map_error(file, {"", "", 1 << 20}), file +
                                                    ": reading 1024 x 512 pixels of 3 channels takes 7864320 "
                                                    "bytes; allowed are 1048576 (--max-memory)");
  EXPECT_EQ(map_error(file, {"", "", 7864320}), "no FileError");
}

TEST_F(Formats, TilesBeyondWhatAFileCanHoldAreRefused) {
  ImageSpec spec(16, 16, 3);
  spec.tile_width = spec.tile_height = 16;
  const std::string exr = bytes(write("a.exr", spec, std::vector<float>(16 * 16 * 3)));
  const std::size_t tiles = exr.find(std::string("tiledesc\0", 9)) + 9 + 4;
  std::string huge = exr;
  huge.replace(tiles, 8, std::string("\0\x40\0\0\0\x40\0\0", 8));  // 16384 x 16384
  EXPECT_TRUE(contains(map_error(write_bytes("tiles.exr", huge)), "in tiles of 16384 x 16384"));
  spec.set_format(OIIO::TypeUInt8);
  std::string tiff = bytes(write("a.tif", spec, std::vector<std::uint8_t>(16 * 16 * 3)));
  for (const char tag : {'\x42', '\x43'}) {  // TileWidth, TileLength
    const std::size_t entry = tiff.find(std::string{tag, '\x01'} + std::string("\x04\0\x01\0\0\0", 6));
    const std::size_t shorts = tiff.find(std::string{tag, '\x01'} + std::string("\x03\0\x01\0\0\0", 6));
    tiff.replace(std::min(entry, shorts) + 8, 4, std::string("\0\x40\0\0", 4));
  }
  EXPECT_TRUE(contains(map_error(write_bytes("tiles.tif", tiff)), "in tiles of 16384 x 16384"));
}

}  // namespace
}  // namespace mica::host::formats_test
