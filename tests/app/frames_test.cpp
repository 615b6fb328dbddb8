// `mica render` of jobs with frames.
#include <OpenImageIO/imageio.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/app/command.h"

namespace mica::host::app::frames_test {
namespace {

constexpr int kSomeFailed = 1, kUsage = 2;

// A sphere whose light passes over it, and a sea that moves.
const char* const kJob = R"([image]
width = 24
height = 16
subpixels = 1
[frames]
range = [2, 5]
rate = 2
[camera]
position = [0.0, -4.0, 1.5]
look_at = [0.0, 0.0, 0.0]
fov = 40
[surface.noise]
generate = "spectrum"
resolution = 64
[surface.sea]
generate = "waves"
resolution = 64
patch = 60
wind_speed = 3
[material.metal]
surface = "noise"
roughness = 0.1
[material.water]
surface = "sea"
roughness = 0.1
[[shape]]
type = "sphere"
material = "metal"
[[shape]]
type = "plane"
material = "water"
center = [0.0, 0.0, -1.0]
[[light]]
type = "directional"
direction = [0.3, 1.0, -0.8]
keys = [{ frame = 2, direction = [0.3, 1.0, -0.8] }, { frame = 5, direction = [-0.3, 1.0, -0.8] }]
)";

class FramesCommand : public CommandTest {
 protected:
  FramesCommand() { write("job.toml", kJob); }

  std::vector<float> pixels(const std::string& file) const {
    const auto input = OIIO::ImageInput::open(path(file));
    std::vector<float> values(input ? input->spec().image_pixels() * input->spec().nchannels : 0);
    EXPECT_TRUE(input && input->read_image(0, 0, 0, -1, OIIO::TypeFloat, values.data())) << file;
    return values;
  }
};

TEST_F(FramesCommand, NumberTheirFiles) {
  const Outcome outcome = mica("render job.toml -o sub/a.exr --json a.json --quiet");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(files(),
            (std::set<std::string>{"job.toml", "sub", "a.0002.exr", "a.0002.png", "a.0003.exr", "a.0003.png",
                                   "a.0004.exr", "a.0004.png", "a.0005.exr", "a.0005.png", "a.json"}));
  const auto report = nlohmann::json::parse(bytes(path("a.json")));
  ASSERT_EQ(report["frames"].size(), 4u);
  for (int n = 0; n < 4; ++n) EXPECT_EQ(report["frames"][n]["frame"], 2 + n);
  EXPECT_NE(pixels("sub/a.0002.exr"), pixels("sub/a.0003.exr"));
}

// A frame is the same whichever frames were rendered before it, and what moves is what its time says.
TEST_F(FramesCommand, DependOnTheirNumberAlone) {
  ASSERT_EQ(mica("render job.toml -o a.exr --quiet").code, 0);
  ASSERT_EQ(mica("render job.toml -o b.exr --frames 4 --quiet").code, 0);
  EXPECT_EQ(pixels("a.0004.exr"), pixels("b.0004.exr"));

  // Frame 4 is 2 s after frame 0; two thirds of the way between the light's keys, which lie as far from (0,
  // 1, -0.8) on either side: beyond it by a third of that angle.
  const double length = std::hypot(1.0, 0.8), x = length * std::tan(std::atan(0.3 / length) / 3);
  std::string still = kJob;
  const auto replace = [&](const std::string& from, const std::string& to) {
    still.replace(still.find(from), from.size(), to);
  };
  replace("[frames]\nrange = [2, 5]\nrate = 2\n", "");
  replace("wind_speed = 3", "wind_speed = 3\ntime = 2");
  still = still.substr(0, still.find("direction = [0.3")) + "direction = [" + std::to_string(-x) +
          ", 1.0, -0.8]\n";
  write("still.toml", still);
  ASSERT_EQ(mica("render still.toml -o still.exr --quiet").code, 0);
  const std::vector<float> moving = pixels("a.0004.exr"), standing = pixels("still.exr");
  for (std::size_t n = 0; n < moving.size(); ++n) EXPECT_NEAR(moving[n], standing[n], 1e-5f) << n;
}

// How a pixel's filter is cut follows the map, which is another one in each frame.
TEST_F(FramesCommand, DependOnTheirNumberAloneWhereFootprintsAreFitted) {
  std::string settings = " --quiet";
  for (const char* set :
       {"image.filter=gaussian", "image.subpixels=4", "image.width=96", "image.height=64",
        "image.aovs=['queries']", "accuracy.tolerance=0.001", "material.metal.ndf=triangles",
        "material.water.ndf=triangles", "material.water.roughness=0.03", "material.water.repeat=[8,8]"})
    settings += std::string(" --set \"") + set + "\"";
  ASSERT_EQ(mica("render job.toml -o a.exr" + settings).code, 0);
  ASSERT_EQ(mica("render job.toml -o b.exr --frames 4" + settings).code, 0);
  EXPECT_EQ(pixels("a.0004.exr"), pixels("b.0004.exr"));
}

TEST_F(FramesCommand, GoOnWhenOneFails) {
  std::filesystem::create_directory(path("a.0003.exr"));
  const Outcome outcome = mica("render job.toml -o a.exr --frames 2-4 --json a.json --quiet");
  EXPECT_EQ(outcome.code, kSomeFailed) << outcome.err;
  EXPECT_NE(outcome.err.find("frame 3"), std::string::npos) << outcome.err;
  EXPECT_TRUE(std::filesystem::is_regular_file(path("a.0002.exr")));
  EXPECT_TRUE(std::filesystem::is_regular_file(path("a.0004.exr")));
  const auto report = nlohmann::json::parse(bytes(path("a.json")));
  EXPECT_NE(report["frames"][1]["error"].get<std::string>().find("a.0003.exr"), std::string::npos);
}

TEST_F(FramesCommand, RefuseWhatTheJobHasNot) {
  const std::set<std::string> before = files();
  for (const char* frames : {"1-3", "2-6", "7", "5-3", "x", "2-", "-3", "2-3-4", "2.5"}) {
    const Outcome outcome = mica(std::string("render job.toml --quiet --frames=") + frames);
    EXPECT_EQ(outcome.code, kUsage) << frames << outcome.err;
    EXPECT_NE(outcome.err.find("--frames"), std::string::npos) << outcome.err;
  }
  EXPECT_EQ(files(), before);
}

}  // namespace
}  // namespace mica::host::app::frames_test
