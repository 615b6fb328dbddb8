#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <cmath>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "host/image/image.h"
#include "mica/error.h"
#include "tests/image/folder.h"

namespace mica::host::write_test {
namespace {

namespace fs = std::filesystem;
using WriteImage = FolderTest;

Image gradient() {
  Image image{7, 5, {"R", "G", "B", "ndf.Y", "uv.U"}, {}, {}};
  for (int i = 0; i < 7 * 5 * 5; ++i) image.pixels.push_back(0.37f * static_cast<float>(i * i) - 3.25f);
  image.metadata = {{"mica:device", "pthread-AMD \"EPYC\""}, {"mica:job", "00ff17"}, {"Copyright", "nobody"}};
  return image;
}

std::vector<std::uint8_t> read_png(const std::string& path, int channels) {
  auto input = OIIO::ImageInput::open(path);
  EXPECT_TRUE(input);
  if (!input) return {};
  EXPECT_EQ(input->spec().nchannels, channels);
  EXPECT_EQ(input->spec().format, OIIO::TypeUInt8);
  std::vector<std::uint8_t> values(input->spec().image_bytes());
  EXPECT_TRUE(input->read_image(0, 0, 0, channels, OIIO::TypeUInt8, values.data()));
  return values;
}

TEST_F(WriteImage, ExrKeepsChannelsValuesAndMetadata) {
  const Image image = gradient();
  write_exr(path("a.exr"), image);
  EXPECT_EQ(file_count(), 1u);

  auto input = OIIO::ImageInput::open(path("a.exr"));
  ASSERT_TRUE(input) << OIIO::geterror();
  const OIIO::ImageSpec& spec = input->spec();
  EXPECT_EQ(spec.width, 7);
  EXPECT_EQ(spec.height, 5);
  EXPECT_EQ(spec.format, OIIO::TypeFloat);
  EXPECT_EQ(spec.get_string_attribute("compression"), "zip");
  for (const auto& [name, value] : image.metadata) EXPECT_EQ(spec.get_string_attribute(name), value) << name;

  std::vector<float> values(7 * 5 * 5);
  ASSERT_TRUE(input->read_image(0, 0, 0, 5, OIIO::TypeFloat, values.data()));
  for (std::size_t channel = 0; channel < 5; ++channel) {
    const int stored = spec.channelindex(image.channels[channel]);
    ASSERT_GE(stored, 0) << image.channels[channel];
    for (std::size_t pixel = 0; pixel < 35; ++pixel)
      EXPECT_EQ(values[pixel * 5 + static_cast<std::size_t>(stored)], image.pixels[pixel * 5 + channel]);
  }
}

TEST_F(WriteImage, PngIsScaledToSrgb) {
  // Reference values: IEC 61966-2-1 evaluated by hand: 0.5 -> 0.7354 -> 188, 0.18 -> 0.4614 -> 118, 0.001
  // -> 3.
  const Image image{2,
                    2,
                    {"B", "R", "G", "A"},
                    {0.25f, 0.09f, 0.0005f, 9, 0, 0.5f, -1, 9, 0.4f, 1, 1e9f, 9, NAN, 0.0005f, INFINITY, 9},
                    {}};
  write_png(path("a.png"), image, 1.0);
  const std::vector<std::uint8_t> expected_first = {118, 3, 188};
  const std::vector<std::uint8_t> values = read_png(path("a.png"), 3);
  ASSERT_EQ(values.size(), 12u);
  EXPECT_EQ(std::vector<std::uint8_t>(values.begin(), values.begin() + 3), expected_first);
  EXPECT_EQ(values[4], 0) << "negative";
  EXPECT_EQ(values[7], 255) << "very bright";
  EXPECT_EQ(values[8], 231) << "0.8, the knee: 0.9063";
  EXPECT_EQ(values[10], 255) << "infinite";
  EXPECT_EQ(values[11], 0) << "NaN";
}

TEST_F(WriteImage, PngRollsOffMonotonically) {
  Image ramp{256, 1, {"Y"}, {}, {}};
  for (int i = 0; i < 256; ++i) ramp.pixels.push_back(static_cast<float>(i) / 64);
  write_png(path("ramp.png"), ramp, 0);
  const std::vector<std::uint8_t> values = read_png(path("ramp.png"), 1);
  ASSERT_EQ(values.size(), 256u);
  for (std::size_t i = 1; i < 256; ++i) EXPECT_GE(values[i], values[i - 1]);
  EXPECT_LT(values[64], 255) << "radiance 1 is not clipped yet";
  EXPECT_EQ(values[255], 255);
}

TEST_F(WriteImage, SameImageSameBytes) {
  Image image = gradient();
  write_exr(path("a.exr"), image);
  write_png(path("a.png"), image, 0);
  const std::string exr = bytes(path("a.exr")), png = bytes(path("a.png"));
  // Two writes within a second would share a time stamp: look for it.
  EXPECT_EQ(OIIO::ImageInput::open(path("a.exr"))->spec().get_string_attribute("DateTime"),
            "1970:01:01 00:00:00");
  write_exr(path("a.exr"), image);
  write_png(path("a.png"), image, 0);
  EXPECT_EQ(bytes(path("a.exr")), exr);
  EXPECT_EQ(bytes(path("a.png")), png);
}

TEST_F(WriteImage, WritingReplacesWholeFiles) {
  std::ofstream(path("a.txt")) << "something longer than what follows";
  write_file_atomically(path("a.txt"), std::string("with\0zero", 9));
  EXPECT_EQ(bytes(path("a.txt")), std::string("with\0zero", 9));
  EXPECT_EQ(file_count(), 1u);
}

TEST_F(WriteImage, WritingWorksInTheWorkingFolder) {
  const fs::path before = fs::current_path();
  fs::current_path(folder_);
  write_file_atomically("plain.txt", "here");
  fs::current_path(before);
  EXPECT_EQ(bytes(path("plain.txt")), "here");
}

TEST_F(WriteImage, UnwritableTargetsLeaveNothing) {
  EXPECT_EQ(error([&] { write_exr(path("missing/a.exr"), gradient()); }),
            path("missing/a.exr") + ": cannot create: No such file or directory");
  EXPECT_FALSE(fs::exists(path("missing")));

  std::ofstream(path("file")) << "x";
  EXPECT_EQ(error([&] { write_png(path("file/a.png"), gradient(), 0); }),
            path("file/a.png") + ": cannot create: Not a directory");

  fs::create_directory(path("folder"));
  EXPECT_EQ(error([&] { write_exr(path("folder"), gradient()); }),
            path("folder") + ": cannot write: exists and is not a regular file");
  EXPECT_TRUE(fs::is_empty(path("folder")));
  EXPECT_EQ(file_count(), 2u);
}

TEST_F(WriteImage, DevicesAndPipesAreNotReplaced) {
  ASSERT_EQ(mkfifo(path("pipe").c_str(), 0600), 0);
  EXPECT_EQ(error([&] { write_file_atomically(path("pipe"), "x"); }),
            path("pipe") + ": cannot write: exists and is not a regular file");
  EXPECT_TRUE(fs::is_fifo(path("pipe")));
  EXPECT_EQ(file_count(), 1u);
}

TEST_F(WriteImage, ReasonsOfTheSystemAreNamed) {
  const std::string name = path(std::string(252, 'n') + ".exr");
  EXPECT_EQ(error([&] { write_exr(name, gradient()); }), name + ": cannot write: File name too long");
  write_exr(path(std::string(251, 'n') + ".exr"), gradient());  // as long as the file system allows
  std::filesystem::remove(path(std::string(251, 'n') + ".exr"));
  EXPECT_EQ(file_count(), 0u);
}

TEST_F(WriteImage, WritesThatStopHalfwayLeaveTheOldFile) {
  write_file_atomically(path("a.txt"), "old");
  rlimit before;
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{1000, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const std::string message = error([&] { write_file_atomically(path("a.txt"), std::string(5000, 'x')); });
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);

  EXPECT_EQ(message, path("a.txt") + ": cannot write: File too large");
  EXPECT_EQ(bytes(path("a.txt")), "old");
  EXPECT_EQ(file_count(), 1u);
}

TEST_F(WriteImage, InconsistentImagesAreRefused) {
  Image image = gradient();
  image.pixels.pop_back();
  EXPECT_EQ(error([&] { write_exr(path("a.exr"), image); }),
            path("a.exr") + ": image of 7 x 5 pixels and 5 channels has 174 values instead of 175");
  EXPECT_EQ(error([&] { write_exr(path("a.exr"), Image{}); }),
            path("a.exr") + ": cannot write an empty image");
  EXPECT_EQ(error([&] {
              write_png(path("a.png"), Image{1, 1, {"R", "G"}, {0, 0}, {}}, 0);
            }),
            path("a.png") + ": a PNG needs the channels R, G, B or a single channel");
  EXPECT_EQ(file_count(), 0u);
}

}  // namespace
}  // namespace mica::host::write_test
