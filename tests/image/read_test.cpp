#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "host/image/image.h"
#include "tests/image/folder.h"

namespace mica::host::read_test {
namespace {

using ReadRgb = FolderTest;

template <class Value>
void write(const std::string& path, int width, int height, int channels, const std::vector<Value>& values) {
  const OIIO::ImageSpec spec(width, height, channels, OIIO::BaseTypeFromC<Value>::value);
  auto output = OIIO::ImageOutput::create(path);
  ASSERT_TRUE(output && output->open(path, spec));
  ASSERT_TRUE(output->write_image(spec.format, values.data()));
  ASSERT_TRUE(output->close());
}

void write_bytes(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST_F(ReadRgb, FloatsAreReadAsTheyAre) {
  const std::vector<float> values = {1.5f, -2, 1e-20f, 3, 4, 65504, 7, 8, 9, 10, 11, 12};
  write(path("a.exr"), 2, 2, 3, values);
  const Image image = read_rgb(path("a.exr"));
  EXPECT_EQ(image.width, 2);
  EXPECT_EQ(image.height, 2);
  EXPECT_EQ(image.channels, (std::vector<std::string>{"R", "G", "B"}));
  EXPECT_EQ(image.pixels, values);
}

TEST_F(ReadRgb, IntegersAreDecodedFromSrgb) {
  // IEC 61966-2-1: 188 -> 0.5029, 3 -> 0.000911, linear below 0.04045.
  write<std::uint8_t>(path("a.png"), 1, 2, 3, {188, 3, 0, 255, 0, 188});
  const Image image = read_rgb(path("a.png"));
  const std::vector<float> expected = {0.50289f, 0.00091058f, 0, 1, 0, 0.50289f};
  ASSERT_EQ(image.pixels.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(image.pixels[i], expected[i], 1e-5f);
}

TEST_F(ReadRgb, OneChannelBecomesGreyAndAlphaIsLeftOut) {
  write<float>(path("grey.exr"), 2, 1, 1, {0.25f, 4});
  EXPECT_EQ(read_rgb(path("grey.exr")).pixels, (std::vector<float>{0.25f, 0.25f, 0.25f, 4, 4, 4}));
  write<float>(path("alpha.exr"), 1, 1, 4, {1, 2, 3, 0.5f});
  EXPECT_EQ(read_rgb(path("alpha.exr")).pixels, (std::vector<float>{1, 2, 3}));
}

TEST_F(ReadRgb, UnusableFilesAreNamedWithTheReason) {
  EXPECT_EQ(error([&] { read_rgb(path("none.exr")); }),
            path("none.exr") + ": cannot read: No such file or directory");
  EXPECT_EQ(error([&] { read_rgb(folder_.string()); }),
            folder_.string() + ": cannot read: is a directory, expected an image");
  write_bytes(path("empty.exr"), "");
  EXPECT_EQ(error([&] { read_rgb(path("empty.exr")); }),
            path("empty.exr") + ": cannot read: the file is empty");
  write_bytes(path("a.psd"), "8BPS");
  EXPECT_EQ(error([&] { read_rgb(path("a.psd")); }),
            path("a.psd") +
                ": cannot read: is not an image that Mica knows: EXR, HDR, PNG, TIFF (TX), JPEG, WebP, BMP, "
                "DDS, TGA, PNM");
  for (const char* name : {"text.exr", "text.png", "text.hdr", "text.tif", "text.jpg"}) {
    write_bytes(path(name), "this is no image at all, whatever its name may be");
    EXPECT_EQ(error([&] { read_rgb(path(name)); }).find(path(name) + ": cannot read: "), 0u) << name;
  }
}

TEST_F(ReadRgb, TruncatedFilesAreRefused) {
  std::vector<float> noise(64 * 64 * 3);
  for (std::size_t i = 0; i < noise.size(); ++i) noise[i] = static_cast<float>((i * 2654435761u) % 1000003);
  write(path("whole.exr"), 64, 64, 3, noise);
  std::vector<std::uint8_t> noise_bytes(noise.begin(), noise.end());
  write(path("whole.png"), 64, 64, 3, noise_bytes);
  for (const char* type : {".exr", ".png"}) {
    const std::string whole = bytes(path(std::string("whole") + type));
    for (const std::size_t size : {whole.size() / 2, whole.size() / 8, std::size_t{20}}) {
      const std::string file = path("part" + std::to_string(size) + type);
      write_bytes(file, whole.substr(0, size));
      EXPECT_TRUE(contains(error([&] { read_rgb(file); }), file + ": ")) << file;
    }
  }
}

TEST_F(ReadRgb, HeadersThatClaimTooMuchAreRefused) {
  write_bytes(path("huge.hdr"), "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 60000 +X 60000\n0123456789");
  EXPECT_TRUE(
      contains(error([&] { read_rgb(path("huge.hdr")); }), "the header declares 60000 x 60000 pixels"));
  write_bytes(path("wide.hdr"), "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 90000\n0123456789");
  EXPECT_TRUE(contains(error([&] { read_rgb(path("wide.hdr")); }),
                       "90000 x 2 pixels of 3 channels; an image has at most"));

  write<float>(path("a.exr"), 4, 4, 3, std::vector<float>(48, 1.0f));
  std::string exr = bytes(path("a.exr"));
  const std::size_t box = exr.find("dataWindow") + std::string("dataWindow.box2i.....").size();
  const std::uint32_t last = 50000;
  exr.replace(box + 8, 4, reinterpret_cast<const char*>(&last), 4);
  exr.replace(box + 12, 4, reinterpret_cast<const char*>(&last), 4);
  write_bytes(path("huge.exr"), exr);
  EXPECT_TRUE(contains(error([&] { read_rgb(path("huge.exr")); }), path("huge.exr") + ": "));
}

TEST_F(ReadRgb, LargeButTrueFilesAreRead) {
  // Constant pixels compress a thousandfold and are no attack.
  write<std::uint8_t>(path("constant.png"), 2048, 1024, 3, std::vector<std::uint8_t>(2048 * 1024 * 3, 255));
  EXPECT_EQ(read_rgb(path("constant.png")).pixels.back(), 1.0f);
}

TEST_F(ReadRgb, PixelsMustBeFinite) {
  write<float>(path("nan.exr"), 2, 2, 3, {0, 0, 0, 0, 0, 0, 0, NAN, 0, 0, 0, 0});
  EXPECT_EQ(error([&] { read_rgb(path("nan.exr")); }),
            path("nan.exr") + ": pixel (0, 1) from the top left is nan, expected finite values");
  write<float>(path("infinite.exr"), 2, 1, 1, {0, INFINITY});
  EXPECT_EQ(error([&] { read_rgb(path("infinite.exr")); }),
            path("infinite.exr") + ": pixel (1, 0) from the top left is inf, expected finite values");
}

}  // namespace
}  // namespace mica::host::read_test
