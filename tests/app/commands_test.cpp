// `mica ndf`, `map`, `devices`, `selftest` and the help.
#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/app/command.h"

namespace mica::host::app::commands_test {
namespace {

class Commands : public CommandTest {
 protected:
  void succeed(const std::string& arguments) const {
    const Outcome outcome = mica(arguments);
    EXPECT_EQ(outcome.code, 0) << arguments << "\n" << outcome.err;
    EXPECT_EQ(outcome.out, "");
  }
  /// A map of one normal, which leans to the right and up.
  void write_flat_map() const {
    write_map("flat.exr", Surface(8, 8, Interpolation::bilinear,
                                  std::vector<Eigen::Vector2d>(64, Eigen::Vector2d(0.25, 0.5))));
  }
  /// The only channel.
  Image grey(const std::string& file) const { return read_rgb(path(file)); }
  static float pixel(const Image& image, int column, int row) {
    return image.pixels[static_cast<std::size_t>((row * image.width + column) * 3)];
  }
};

TEST_F(Commands, NdfShowsTheDiskWithTUp) {
  write_flat_map();
  succeed(
      "ndf --map flat.exr --center 0.3,0.3 --sigma 2,1,30 --roughness 0.05 --ndf triangles --size 64 -o "
      "n.exr");
  const Image image = grey("n.exr");
  ASSERT_EQ(image.width, 64);
  ASSERT_EQ(image.height, 64);
  double sum = 0;
  for (int row = 0; row < 64; ++row) {
    for (int column = 0; column < 64; ++column) {
      const Eigen::Vector2d half((column + 0.5) / 32 - 1, 1 - (row + 0.5) / 32);
      const double d2 = (half - Eigen::Vector2d(0.25, 0.5)).squaredNorm() / (0.05 * 0.05);
      const double expected = half.norm() < 1 ? std::exp(-d2 / 2) / (2 * 3.14159265358979 * 0.05 * 0.05) : 0;
      EXPECT_NEAR(pixel(image, column, row), expected, 1e-4 * expected + 1e-4) << column << ", " << row;
      sum += pixel(image, column, row);
    }
  }
  EXPECT_NEAR(sum / (32 * 32), 1, 1e-4);
}

TEST_F(Commands, NdfShowsAWindow) {
  write_flat_map();
  succeed(
      "ndf --map flat.exr --center=-7.3,0.3 --sigma 2 --roughness 0.05 --ndf reference --size 3 "
      "--window 0.25,0.5,0.15 -o n.exr");
  const Image image = grey("n.exr");
  const double peak = 1 / (2 * 3.14159265358979 * 0.05 * 0.05),
               beside = peak * std::exp(-2);  // two roughnesses away
  EXPECT_NEAR(pixel(image, 1, 1), peak, 1e-4 * peak);
  EXPECT_NEAR(pixel(image, 0, 1), beside, 1e-4 * peak);
  EXPECT_NEAR(pixel(image, 1, 2), beside, 1e-4 * peak);
}

TEST_F(Commands, NdfPreviewShowsItsBrightPart) {
  write_flat_map();
  succeed("ndf --map flat.exr --center 0,0 --sigma 1 --roughness 0.01 --ndf triangles --size 64 -o n.png");
  const Image image = grey("n.png");
  const auto brightest = std::max_element(image.pixels.begin(), image.pixels.end());
  EXPECT_GT(*brightest, 0.75);
  EXPECT_LE(*brightest, 1);
}

TEST_F(Commands, MapMakesWhatTheLibraryMakes) {
  succeed("map spectrum --resolution 32 --rms-slope 0.2 --correlation 4 --seed 1 -o bumps.exr");
  write_map("expected.exr", spectrum());
  const Image made = read_rgb(path("bumps.exr")), expected = read_rgb(path("expected.exr"));
  EXPECT_EQ(made.pixels, expected.pixels);
  succeed("map flakes --resolution 64 --flake-size 8 --alpha 0.3 --seed 5 -o flakes.exr");
  succeed("map flakes --resolution 64 --flake-size 8 --alpha 0.3 --seed 5 -o again.exr");
  succeed("map flakes --resolution 64 --flake-size 8 --alpha 0.3 --seed 6 -o other.exr");
  EXPECT_EQ(bytes(path("flakes.exr")), bytes(path("again.exr")));
  EXPECT_NE(bytes(path("flakes.exr")), bytes(path("other.exr")));
}

TEST_F(Commands, MapMakesEveryKind) {
  const auto make = [&](const std::string& options, const SurfaceDescription& expected) {
    succeed("map " + options + " -o made.exr");
    write_map("expected.exr", make_surface(expected, nullptr));
    EXPECT_EQ(read_rgb(path("made.exr")).pixels, read_rgb(path("expected.exr")).pixels) << options;
  };
  constexpr Interpolation bilinear = Interpolation::bilinear;
  make(
      "brushed --resolution 64 --rms-slope 0.3 --correlation-along 30 --correlation-across 4 --direction 20 "
      "--seed 7",
      {"", BrushedSurface{64, 0.3, 30, 4, 20, 7}, bilinear});
  make(
      "scratches --resolution 64 --density 1 --length 40 --width 6 --depth 1 --variation 0.2 --direction 10 "
      "--spread 30 --bend 0.1 --profile v --seed 7",
      {"", ScratchesSurface{64, 1, 40, 6, 1, 0.2, 10, 30, 0.1, ScratchProfile::v, 7}, bilinear});
  make("dents --resolution 64 --density 1 --radius-low 5 --radius-high 9 --depth 0.2 --seed 7",
       {"", DentsSurface{64, 1, 5, 9, 0.2, 7}, bilinear});
  make("bumps --resolution 64 --cell 16 --size 1 --aspect 2 --slope 0.5 --jitter 0.3 --seed 7",
       {"", BumpsSurface{64, 16, 1, 2, 0.5, 0.3, 7}, bilinear});
  make("waves --resolution 64 --patch 100 --wind-speed 5 --wind-direction 40 --time 2.5 --seed 7",
       {"", WavesSurface{64, 100, 5, 40, 2.5, 1, 7}, bilinear});
}

TEST_F(Commands, MapAddsLayers) {
  succeed("map spectrum --resolution 32 --rms-slope 0.2 --correlation 4 --seed 1 -o bumps.exr");
  succeed("map layers --layer bumps.exr --weight 0.25 --layer bumps.exr --weight 0.75 -o sum.exr");
  const Image sum = read_rgb(path("sum.exr")), bumps = read_rgb(path("bumps.exr"));
  for (std::size_t n = 0; n < sum.pixels.size(); ++n) ASSERT_NEAR(sum.pixels[n], bumps.pixels[n], 1e-6);
  const Outcome outcome = mica("map layers --layer bumps.exr --layer bumps.exr --weight 1 -o no.exr");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.err.find("--weight"), std::string::npos) << outcome.err;
}

TEST_F(Commands, DevicesAreListed) {
  const Outcome outcome = mica("devices --json devices.json");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const nlohmann::json json = nlohmann::json::parse(bytes(path("devices.json")));
  ASSERT_FALSE(json.at("devices").empty());
  const nlohmann::json& first = json.at("devices")[0];
  EXPECT_EQ(outcome.out.rfind("0: " + first.at("name").get<std::string>() + "\n", 0), 0u) << outcome.out;
  EXPECT_GT(first.at("compute_units"), 0);
  EXPECT_GT(first.at("memory_bytes"), 0);
  EXPECT_GT(first.at("largest_buffer_bytes"), 0);
}

TEST_F(Commands, ThereIsNoDevice99) {
  const Outcome outcome = mica("selftest --device 99 --json selftest.json");
  EXPECT_EQ(outcome.code, 3);
  EXPECT_NE(outcome.err.find("no OpenCL device 99"), std::string::npos) << outcome.err;
  EXPECT_TRUE(files().empty());
}

TEST_F(Commands, SelftestPassesHere) {
  const Outcome outcome = mica("selftest --json selftest.json");
  EXPECT_EQ(outcome.code, 0) << outcome.out << outcome.err;
  const nlohmann::json json = nlohmann::json::parse(bytes(path("selftest.json")));
  EXPECT_EQ(json.at("pass"), true);
  EXPECT_GT(json.at("checks").size(), 20u);
  for (const nlohmann::json& check : json.at("checks")) EXPECT_GT(check.at("points"), 0) << check;
}

TEST_F(Commands, HelpIsData) {
  for (const char* const command : {"", "eval", "ndf", "map", "map spectrum", "map flakes", "map layers",
                                    "devices", "selftest", "bench"}) {
    const Outcome outcome = mica(std::string(command) + " --help");
    EXPECT_EQ(outcome.code, 0) << command;
    EXPECT_NE(outcome.out.find("Usage"), std::string::npos) << command;
    EXPECT_EQ(outcome.err, "") << command;
  }
}

}  // namespace
}  // namespace mica::host::app::commands_test
