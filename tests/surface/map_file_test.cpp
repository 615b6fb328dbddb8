#include "host/surface/map_file.h"

#include <cmath>
#include <limits>

#include "host/surface/disk.h"
#include "host/surface/export.h"
#include "host/surface/synthesis.h"
#include "tests/surface/map_images.h"

namespace mica::host::test::map_file_test {
namespace {

const float kNan = std::numeric_limits<float>::quiet_NaN();
const float kInfinity = std::numeric_limits<float>::infinity();

/// Height sin(k i) + 0.7 sin(k j) / k, which rises by at most 1 and 0.7 a texel, and its central differences.
struct Waves {
  static constexpr int size = 64;
  static constexpr double k = 2 * M_PI / size;
  static double height(int i, int j) { return (std::sin(k * i) + 0.7 * std::sin(k * j)) / k; }
  static Eigen::Vector2d slope(int i, int j) { return {std::cos(k * i), 0.7 * std::cos(k * j)}; }
  /// (sin(k (i + 1)) - sin(k (i - 1))) / 2 = cos(k i) sin(k)
  static Eigen::Vector2d central_difference(int i, int j) { return std::sin(k) / k * slope(i, j); }
};

/// Image of `channels` channels from a function of (i, j, channel), j from the bottom.
template <typename Function>
std::vector<float> pixels(int width, int height, int channels, const Function& function) {
  std::vector<float> result;
  for (int j = height - 1; j >= 0; --j) {
    for (int i = 0; i < width; ++i) {
      for (int channel = 0; channel < channels; ++channel) {
        result.push_back(static_cast<float>(function(i, j, channel)));
      }
    }
  }
  return result;
}

double largest_difference(const Surface& a, const Surface& b) {
  double largest = 0;
  for (int j = 0; j < a.height(); ++j) {
    for (int i = 0; i < a.width(); ++i) largest = std::max(largest, (a.texel(i, j) - b.texel(i, j)).norm());
  }
  return largest;
}

Surface rough_surface() {
  SurfaceDescription description;
  SpectrumSurface spectrum;
  spectrum.resolution = 32;
  spectrum.rms_slope = 0.5;
  spectrum.correlation_texels = 4;
  description.source = spectrum;
  return make_surface(description, nullptr);
}

/// A float image of flat normals but for one pixel.
std::vector<float> flat_but(int width, int height, int column, int row, const Eigen::Vector3f& normal) {
  std::vector<float> image;
  for (int pixel = 0; pixel < width * height; ++pixel) image.insert(image.end(), {0, 0, 1});
  for (int channel = 0; channel < 3; ++channel) image[(row * width + column) * 3 + channel] = normal[channel];
  return image;
}

using MapFileTest = MapImages;

TEST_F(MapFileTest, ImageBottomRowIsVNearZero) {
  const auto file =
      write<float>("a.exr", 2, 2, 3, {0.6f, 0, 0.8f, 0, 0, 1, /* bottom */ 0, -0.6f, 0.8f, 0, 0.8f, 0.6f});
  const Surface surface = load(map_file(file));
  EXPECT_NEAR(surface.texel(0, 1).x(), 0.6, 1e-7);
  EXPECT_NEAR(surface.texel(0, 0).y(), -0.6, 1e-7);
  EXPECT_NEAR(surface.texel(1, 0).y(), 0.8, 1e-7);
  EXPECT_NEAR(surface.texel(1, 1).norm(), 0, 1e-7);
}

TEST_F(MapFileTest, SignedExportComesBack) {
  const Surface surface = rough_surface();
  SurfaceReport report;
  const auto file = map_file(write("a.exr", 32, 32, 3, to_signed_rgb(surface)));
  EXPECT_LT(largest_difference(load(file, &report), surface), 2e-7);
  EXPECT_TRUE(mentions(report.notes, "encoding signed assumed from 32-bit float pixels"));
  EXPECT_TRUE(report.warnings.empty());
}

TEST_F(MapFileTest, TwoChannelsImplyTheThird) {
  const Surface surface = rough_surface();
  const auto image =
      pixels(32, 32, 2, [&](int i, int j, int channel) { return surface.texel(i, j)[channel]; });
  const auto name_channels = [](OIIO::ImageSpec& spec) { spec.channelnames = {"R", "G"}; };
  const auto file = map_file(write("a.exr", 32, 32, 2, image, name_channels), Encoding::signed_float);
  EXPECT_LT(largest_difference(load(file), surface), 1e-7);
}

TEST_F(MapFileTest, UnormIsExactToHalfAStep) {
  const Surface surface = rough_surface();
  const std::vector<float> image = to_signed_rgb(surface);
  std::vector<std::uint8_t> bytes;
  std::vector<std::uint16_t> words;
  std::vector<float> floats;
  for (const float n : image) {
    bytes.push_back(static_cast<std::uint8_t>(std::lround(255 * (0.5 * n + 0.5))));
    words.push_back(static_cast<std::uint16_t>(std::lround(65535 * (0.5 * n + 0.5))));
    floats.push_back(0.5f * n + 0.5f);
  }
  for (const std::string extension : {"png", "tif"}) {
    SurfaceReport coarse, fine;
    // Half a step in each of x, y and z.
    EXPECT_LT(largest_difference(load(map_file(write("8." + extension, 32, 32, 3, bytes)), &coarse), surface),
              std::sqrt(3.0) / 255);
    EXPECT_LT(largest_difference(load(map_file(write("16." + extension, 32, 32, 3, words)), &fine), surface),
              std::sqrt(3.0) / 65535);
    EXPECT_TRUE(mentions(coarse.notes, "encoding unorm assumed from 8-bit unsigned integer pixels"));
    EXPECT_TRUE(mentions(coarse.warnings, "steps of 0.0078"));
    EXPECT_EQ(coarse.warnings.size(), 1u);  // rounding alone must not count as a wrong length
    EXPECT_TRUE(mentions(fine.notes, "steps of 3.1e-05"));
    EXPECT_TRUE(fine.warnings.empty());
  }
  EXPECT_LT(largest_difference(load(map_file(write("f.exr", 32, 32, 3, floats), Encoding::unorm)), surface),
            4e-7);
}

TEST_F(MapFileTest, PixelsAreTakenAsStored) {
  // No sRGB curve, no multiplication by alpha: (200, 90, 220) / 255 whatever the alpha is.
  const Eigen::Vector3d n = 2 * Eigen::Vector3d(200, 90, 220) / 255 - Eigen::Vector3d::Ones();
  const Eigen::Vector2d expected = n.normalized().head<2>();
  const auto srgb = [](OIIO::ImageSpec& spec) {
    spec.attribute("oiio:ColorSpace", "sRGB");
    spec.attribute("oiio:UnassociatedAlpha", 1);
  };
  for (const std::string extension : {"png", "tif"}) {
    SurfaceReport report;
    const auto file = write<std::uint8_t>("a." + extension, 1, 1, 4, {200, 90, 220, 50}, srgb);
    EXPECT_LT((load(map_file(file), &report).texel(0, 0) - expected).norm(), 1e-6) << extension;
    EXPECT_TRUE(mentions(report.notes, "ignored: A"));
  }
}

TEST_F(MapFileTest, HeightsBecomeCentralDifferences) {
  const int size = Waves::size;
  const double scale = 0.25;
  const auto image = pixels(size, size, 1, [&](int i, int j, int) { return Waves::height(i, j) / scale; });
  MapFile file = map_file(write("h.exr", size, size, 1, image), Encoding::height);
  file.height_scale = scale;
  const Surface surface = load(file);
  for (int j = 0; j < size; ++j) {
    for (int i = 0; i < size; ++i) {
      ASSERT_LT((surface.texel(i, j) - disk_from_slope(Waves::central_difference(i, j))).norm(), 2e-6)
          << i << ", " << j;
    }
  }
}

TEST_F(MapFileTest, EncodingsOfOneSurfaceAgree) {
  const int size = Waves::size;
  const auto heights = pixels(size, size, 1, [](int i, int j, int) { return Waves::height(i, j); });
  const auto slopes =
      pixels(size, size, 2, [](int i, int j, int channel) { return Waves::slope(i, j)[channel]; });
  const auto normals = pixels(size, size, 3, [](int i, int j, int channel) {
    const Eigen::Vector2d slope = Waves::slope(i, j);
    return Eigen::Vector3d(-slope.x(), -slope.y(), 1).normalized()[channel];
  });
  const auto name_channels = [](OIIO::ImageSpec& spec) { spec.channelnames = {"R", "G"}; };
  const Surface from_heights = load(map_file(write("h.exr", size, size, 1, heights), Encoding::height));
  const Surface from_slopes =
      load(map_file(write("s.exr", size, size, 2, slopes, name_channels), Encoding::slope));
  const Surface from_normals = load(map_file(write("n.exr", size, size, 3, normals), Encoding::signed_float));
  EXPECT_LT(largest_difference(from_slopes, from_normals), 2e-7);
  EXPECT_LT(largest_difference(from_heights, from_normals),
            2 * Waves::k * Waves::k / 6);  // the error of central differences
}

TEST_F(MapFileTest, GreenDownTurnsTheSecondChannel) {
  const auto file = write<float>("a.exr", 1, 1, 3, {0.36f, 0.48f, 0.8f});
  for (const Encoding encoding : {Encoding::signed_float, Encoding::slope}) {
    MapFile up = map_file(file, encoding), down = up;
    down.green = GreenDirection::down;
    const Eigen::Vector2d s = load(up).texel(0, 0);
    EXPECT_NE(s.y(), 0);
    EXPECT_EQ(load(down).texel(0, 0), Eigen::Vector2d(s.x(), -s.y()));
  }
}

TEST_F(MapFileTest, GreenDoesNothingToHeightsAndSaysSo) {
  const auto image = pixels(4, 4, 1, [](int i, int j, int) { return 0.1 * i * i + 0.2 * j * j; });
  MapFile up = map_file(write("a.exr", 4, 4, 1, image), Encoding::height), down = up;
  down.green = GreenDirection::down;
  SurfaceReport report;
  EXPECT_EQ(load(up).normals(), load(down, &report).normals());
  EXPECT_TRUE(mentions(report.warnings, "green"));
}

TEST_F(MapFileTest, WrongLengthsAreNormalisedAndCounted) {
  SurfaceReport report;
  const auto image = flat_but(3, 2, 2, 1, {0.6f, 0, 1.6f});
  const Surface surface = load(map_file(write("a.exr", 3, 2, 3, image)), &report);
  EXPECT_NEAR(surface.texel(2, 0).x(), 0.6 / std::hypot(0.6, 1.6), 1e-7);
  EXPECT_TRUE(mentions(report.warnings, "1 of 6 texels (the first at column 2, row 1 of the image)"));
  // Within 1%: no matter.
  SurfaceReport quiet;
  load(map_file(write("b.exr", 3, 2, 3, flat_but(3, 2, 2, 1, {0, 0, 1.009f}))), &quiet);
  EXPECT_TRUE(quiet.warnings.empty());
}

TEST_F(MapFileTest, AsksWhetherTheEncodingIsRight) {
  SurfaceReport report;
  const auto file = write<float>("a.exr", 1, 1, 3, {0.5f, 0.5f, 1.0f});  // unorm stored as float
  load(map_file(file, Encoding::signed_float), &report);
  EXPECT_TRUE(mentions(report.warnings, "is the encoding right?"));
}

TEST_F(MapFileTest, FloatsWithoutANegativeAreUnorm) {
  SurfaceReport report;
  const Surface surface = rough_surface();
  std::vector<float> image = to_signed_rgb(surface);
  for (float& value : image) value = 0.5f * value + 0.5f;
  const auto half = [](OIIO::ImageSpec& spec) { spec.set_format(OIIO::TypeDesc::HALF); };
  EXPECT_LT(largest_difference(load(map_file(write("a.exr", 32, 32, 3, image, half)), &report), surface),
            2e-3);
  EXPECT_TRUE(
      mentions(report.notes, "encoding unorm assumed from 16-bit float pixels, none of them negative"));
  EXPECT_TRUE(report.warnings.empty());
  const auto two = [](OIIO::ImageSpec& spec) { spec.channelnames = {"R", "G"}; };
  const auto unclear = write<float>("b.exr", 1, 1, 2, {0.5f, 0.6f}, two);
  EXPECT_NE(message_of<UsageError>([&] { load(map_file(unclear)); }).find("say encoding"), std::string::npos);
}

TEST_F(MapFileTest, EmptyBlueIsAMapOfTwoChannels) {
  const Surface surface = rough_surface();
  const std::vector<float> normals = to_signed_rgb(surface);
  for (const int blue : {0, 127, 128}) {
    std::vector<std::uint8_t> image;
    for (std::size_t n = 0; n < normals.size(); ++n)
      image.push_back(
          static_cast<std::uint8_t>(n % 3 == 2 ? blue : std::lround(255 * (0.5 * normals[n] + 0.5))));
    SurfaceReport report;
    EXPECT_LT(largest_difference(load(map_file(write("a.png", 32, 32, 3, image)), &report), surface),
              std::sqrt(2.0) / 255);
    EXPECT_TRUE(mentions(report.notes, "taken as a map of two channels, R and G")) << blue;
  }
}

TEST_F(MapFileTest, NormalsBelowTheSurfaceMoveToTheRim) {
  SurfaceReport report;
  const auto image = flat_but(2, 2, 0, 0, {0.6f, 0, -0.8f});
  const Surface surface = load(map_file(write("a.exr", 2, 2, 3, image)), &report);
  EXPECT_LT((surface.texel(0, 1) - Eigen::Vector2d(kRim, 0)).norm(), 1e-9);
  EXPECT_TRUE(mentions(report.warnings, "moved to that rim in 1 of 4 texels"));

  const auto name_channels = [](OIIO::ImageSpec& spec) { spec.channelnames = {"R", "G"}; };
  const auto outside = write<float>("b.exr", 1, 1, 2, {-3.0f, 4.0f}, name_channels);
  EXPECT_LT((load(map_file(outside)).texel(0, 0) - kRim * Eigen::Vector2d(-0.6, 0.8)).norm(), 1e-7);
  const auto steep = write<float>("c.exr", 1, 1, 2, {0.0f, 3e38f}, name_channels);
  EXPECT_LT((load(map_file(steep, Encoding::slope)).texel(0, 0) - Eigen::Vector2d(0, -kRim)).norm(), 1e-7);
}

TEST_F(MapFileTest, InvalidTexelsAreRefusedWithTheirPlace) {
  const Eigen::Vector3f invalid[] = {
      {kNan, 0, 1}, {0, kInfinity, 1}, {0, 0, 0}, {0, 0, -1}, {0.001f, 0.002f, 0.003f}};
  for (const Eigen::Vector3f& normal : invalid) {
    const MapFile file = map_file(write("a.exr", 4, 3, 3, flat_but(4, 3, 1, 2, normal)));
    const std::string message = message_of<FileError>([&] { load(file); });
    EXPECT_EQ(message.rfind(file.path, 0), 0u) << message;
    EXPECT_NE(message.find("1 of 12 texels (the first at column 1, row 2 of the image)"), std::string::npos)
        << message;
  }
}

TEST_F(MapFileTest, InvalidTexelsAreFilledFromTheirNeighbours) {
  // Normals lean by 0.1 a texel of distance to the hole, around the seam: the mean of the neighbours is
  // upright.
  const auto name_channels = [](OIIO::ImageSpec& spec) { spec.channelnames = {"R", "G"}; };
  for (const int hole : {0, 2, 4}) {
    const auto image = pixels(5, 5, 2, [&](int i, int j, int channel) {
      if (i == hole && j == hole) return kNan;
      return 0.1f * static_cast<float>(((channel == 0 ? i : j) - hole + 7) % 5 - 2);
    });
    MapFile file = map_file(write("a.exr", 5, 5, 2, image, name_channels));
    file.invalid = TexelRepair::repair;
    SurfaceReport report;
    const Surface surface = load(file, &report);
    EXPECT_LT(surface.texel(hole, hole).norm(), 1e-7) << hole;
    EXPECT_NEAR(surface.texel(hole + 1, hole).x(), 0.1, 1e-7);
    EXPECT_TRUE(mentions(report.warnings, "1 of 25 texels"));
    EXPECT_TRUE(mentions(report.warnings, "filled"));
  }
}

TEST_F(MapFileTest, LargeHolesAreFilledToTheirMiddleAroundTheSeam) {
  // Constant normals with a hole of 7 x 7 across the corner of the map: whatever is filled is that constant.
  const auto image = pixels(12, 12, 3, [](int i, int j, int channel) {
    const bool hole = (i < 4 || i > 8) && (j < 4 || j > 8);
    return hole ? kNan : static_cast<float>(Eigen::Vector3d(0.36, 0.48, 0.8)[channel]);
  });
  MapFile file = map_file(write("a.exr", 12, 12, 3, image));
  file.invalid = TexelRepair::repair;
  const Surface surface = load(file);
  for (const Eigen::Vector2d& s : surface.normals())
    ASSERT_LT((s - Eigen::Vector2d(0.36, 0.48)).norm(), 1e-6);
}

TEST_F(MapFileTest, HeightsAreRepairedBeforeTheyAreDifferentiated) {
  const auto image = pixels(8, 8, 1, [](int i, int j, int) { return i == 3 && j == 3 ? kNan : 2.5f; });
  MapFile file = map_file(write("a.exr", 8, 8, 1, image), Encoding::height);
  EXPECT_THROW(load(file), FileError);
  file.invalid = TexelRepair::repair;
  const Surface surface = load(file);
  for (const Eigen::Vector2d& s : surface.normals()) EXPECT_EQ(s, Eigen::Vector2d(0, 0));
}

TEST_F(MapFileTest, NothingCanBeRepairedFromNothing) {
  MapFile file = map_file(write("a.exr", 2, 2, 3, std::vector<float>(12, kNan)));
  file.invalid = TexelRepair::repair;
  EXPECT_NE(message_of<FileError>([&] { load(file); }).find("4 of 4"), std::string::npos);
}

TEST_F(MapFileTest, EncodingsMustFitThePixels) {
  const MapFile grey = map_file(write<float>("g.exr", 2, 2, 1, {0, 0, 0, 0}));
  EXPECT_NE(message_of<UsageError>([&] { load(grey); }).find("height"), std::string::npos);
  EXPECT_THROW(load(map_file(grey.path, Encoding::signed_float)), UsageError);
  const auto bytes = write<std::uint8_t>("b.png", 1, 1, 3, {128, 128, 255});
  EXPECT_THROW(load(map_file(bytes, Encoding::signed_float)), UsageError);
  EXPECT_THROW(load(map_file(bytes, Encoding::slope)), UsageError);
  MapFile file = map_file(grey.path, Encoding::height);
  file.height_scale = std::nan("");
  EXPECT_THROW(load(file), UsageError);
}

TEST_F(MapFileTest, HalfFloatsSayHowFineTheyAre) {
  SurfaceReport report;
  const auto half = [](OIIO::ImageSpec& spec) { spec.set_format(OIIO::TypeDesc::HALF); };
  load(map_file(write<float>("a.exr", 1, 1, 3, {0, 0, 1}, half)), &report);
  EXPECT_TRUE(mentions(report.notes, "16-bit float pixels hold slopes in steps of 0.00049"));
}

/// Signed ones are the finer the flatter a map is, those of 0..1 are not: above a half they are twice as
/// coarse as below it, and a map has the step whose square is the mean.
TEST_F(MapFileTest, HalfFloatsHaveTheStepOfTheirNormals) {
  const auto half = [](OIIO::ImageSpec& spec) { spec.set_format(OIIO::TypeDesc::HALF); };
  const auto flat = write<float>("a.exr", 2, 1, 3, {0.1f, 0.1f, 0.99f, -0.1f, -0.1f, 0.99f}, half);
  EXPECT_EQ(load(map_file(flat)).step(), std::exp2(-14));
  const auto raised = write<float>("b.exr", 2, 1, 3, {0.55f, 0.55f, 0.99f, 0.45f, 0.45f, 0.99f}, half);
  EXPECT_DOUBLE_EQ(load(map_file(raised)).step(), std::exp2(-10) * std::sqrt((1 + 0.25) / 2));
}

TEST_F(MapFileTest, EightBitHeightsWarnWithTheirOwnStep) {
  SurfaceReport report;
  MapFile file = map_file(write<std::uint8_t>("a.png", 2, 2, 1, {1, 2, 3, 4}), Encoding::height);
  file.height_scale = 51;  // 0.1 texels an image step, half of it a central difference
  load(file, &report);
  EXPECT_TRUE(mentions(report.warnings, "steps of 0.1;")) << report.warnings.at(0);
}

TEST_F(MapFileTest, NamesOtherThanRgbKeepTheirOrder) {
  const auto name_channels = [](OIIO::ImageSpec& spec) {
    spec.channelnames = {"normal.X", "normal.Y", "normal.Z"};
  };
  const auto file = write<float>("a.exr", 1, 1, 3, {0.36f, 0.48f, 0.8f}, name_channels);
  EXPECT_LT((load(map_file(file)).texel(0, 0) - Eigen::Vector2d(0.36, 0.48)).norm(), 1e-7);
}

TEST_F(MapFileTest, DisplayWindowIsThePeriod) {
  const auto part = [](OIIO::ImageSpec& spec) {
    spec.x = 3, spec.y = 5, spec.full_width = spec.full_height = 64;
  };
  const auto more = [](OIIO::ImageSpec& spec) {
    spec.x = spec.y = -1, spec.full_width = spec.full_height = 1;
  };
  const auto image = flat_but(3, 3, 1, 1, {0.6f, 0, 0.8f});
  const auto crop = map_file(write("a.exr", 3, 3, 3, image, part));
  EXPECT_NE(message_of<FileError>([&] { load(crop); }).find("data window"), std::string::npos);
  SurfaceReport report;
  const Surface surface = load(map_file(write("b.exr", 3, 3, 3, image, more)), &report);
  EXPECT_EQ(surface.width(), 1);
  EXPECT_NEAR(surface.texel(0, 0).x(), 0.6, 1e-7);
  EXPECT_TRUE(mentions(report.notes, "data window"));
}

}  // namespace
}  // namespace mica::host::test::map_file_test
