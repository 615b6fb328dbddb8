// `mica render` and `mica check`: what they leave behind, and what they refuse.
#include <OpenImageIO/imageio.h>

#include <nlohmann/json.hpp>

#include "tests/app/command.h"

namespace mica::host::app::render_test {
namespace {

constexpr int kUsage = 2, kDevice = 3, kFile = 4;

// A small picture of a sphere.
const char* const kJob = R"([image]
width = 24
height = 16
subpixels = 2
aovs = ["ndf", "uv"]
[camera]
position = [0.0, -4.0, 1.0]
look_at = [0.0, 0.0, 0.0]
fov = 30
[surface.noise]
generate = "spectrum"
resolution = 64
rms_slope = 0.15
correlation = 8
[material.metal]
surface = "noise"
repeat = [8, 4]
ndf = "triangles"
roughness = 0.02
[[shape]]
type = "sphere"
material = "metal"
[[light]]
type = "directional"
direction = [0.3, 1.0, -0.8]
irradiance = [3.0, 3.0, 3.0]
[audit]
samples = 16
)";

class RenderCommand : public CommandTest {
 protected:
  RenderCommand() { write("job.toml", kJob); }
  static std::string with(const std::string& from, const std::string& to) {
    std::string job = kJob;
    job.replace(job.find(from), from.size(), to);
    return job;
  }
};

TEST_F(RenderCommand, WritesThePictureItsPreviewAndWhatItDid) {
  const Outcome outcome = mica("render job.toml -o sub/a.exr --json a.json --quiet");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(files(), (std::set<std::string>{"job.toml", "sub", "a.exr", "a.png", "a.json"}));

  const auto exr = OIIO::ImageInput::open(path("sub/a.exr"));
  ASSERT_TRUE(exr);
  const OIIO::ImageSpec& spec = exr->spec();
  EXPECT_EQ(spec.width, 24);
  EXPECT_EQ(spec.height, 16);
  EXPECT_EQ(spec.format, OIIO::TypeFloat);
  EXPECT_EQ(spec.channelnames, (std::vector<std::string>{"R", "G", "B", "ndf.Y", "uv.U", "uv.V"}));
  const auto json = nlohmann::json::parse(bytes(path("a.json")));
  EXPECT_EQ(std::string(spec.get_string_attribute("mica:job")), json["job"]["hash"].get<std::string>());
  EXPECT_EQ(json["audit"]["samples"], 16);
  EXPECT_LE(json["audit"]["relative_l2"], 1e-4);
  EXPECT_GT(json["queries"], 0);
}

/// A patch's BRDF is no density: the plan says what will be missing, and only then.
TEST_F(RenderCommand, SaysWhereTheAuditSeesNothing) {
  const std::string both = "[audit] and the AOV ndf see nothing of material metal",
                    aov = "the AOV ndf sees nothing of material metal";
  EXPECT_EQ(mica("check job.toml").out.find("nothing of material"), std::string::npos);
  EXPECT_NE(mica("check job.toml --set material.metal.ndf=normalmap").out.find(both), std::string::npos);
  EXPECT_NE(mica("check job.toml --set material.metal.ndf=beckmanns").out.find(aov), std::string::npos);
}

TEST_F(RenderCommand, GivesTheSameBytesEachTime) {
  ASSERT_EQ(mica("render job.toml -o a.exr --quiet").code, 0);
  ASSERT_EQ(mica("render job.toml -o b.exr --quiet").code, 0);
  EXPECT_EQ(bytes(path("a.exr")), bytes(path("b.exr")));
  EXPECT_EQ(bytes(path("a.png")), bytes(path("b.png")));
}

TEST_F(RenderCommand, OverridesASetting) {
  ASSERT_EQ(mica("render job.toml -o a.exr --quiet --set image.width=7 --set image.aovs=[]").code, 0);
  const auto exr = OIIO::ImageInput::open(path("a.exr"));
  ASSERT_TRUE(exr);
  EXPECT_EQ(exr->spec().width, 7);
  EXPECT_EQ(exr->spec().nchannels, 3);
}

TEST_F(RenderCommand, CheckPrintsThePlanAndRendersNothing) {
  const Outcome outcome = mica("check job.toml");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("triangles on surface noise (64 x 64 texels, bilinear)"), std::string::npos)
      << outcome.out;
  EXPECT_EQ(files(), std::set<std::string>{"job.toml"});
}

TEST_F(RenderCommand, RefusesWithTheRightCodeAndLeavesNoFile) {
  write("empty.toml", "");
  write("broken.toml", "[image\n");
  write("misspelt.toml", with("fov = 30", "fow = 30"));
  write("two_errors.toml", with("width = 24\nheight = 16", "width = -1\nheight = \"tall\""));
  write("no_map.toml", with("generate = \"spectrum\"\nresolution = 64\nrms_slope = 0.15\ncorrelation = 8",
                            "file = \"none.exr\""));
  write("file", "in the way of a folder");
  std::filesystem::create_directories(path("no_drivers"));
  struct Case {
    std::string arguments;
    int code;
    std::vector<std::string> messages;
  };
  const std::vector<Case> cases = {
      {"none.toml", kFile, {"none.toml"}},
      {"empty.toml", kUsage, {"empty.toml:1:1", "[[shape]]", "[[light]]"}},
      {"broken.toml", kUsage, {"broken.toml:1:"}},
      {"misspelt.toml", kUsage, {"misspelt.toml:9:1", "fow"}},
      {"two_errors.toml", kUsage, {"two_errors.toml:2:9", "two_errors.toml:3:10", "-1", "tall"}},
      {"no_map.toml", kUsage, {"no_map.toml:11:8", "none.exr"}},
      {"job.toml --set image.width=0", kUsage, {"image.width"}},
      {"job.toml --frames 1-2", kUsage, {"--frames 1-2"}},
      {"job.toml -o a.tif", kUsage, {"a.tif", ".exr"}},
      {"job.toml -o file/a.exr", kFile, {"file/a.exr"}},
      {"job.toml -o a.exr --json file/a.json", kFile, {"file/a.json"}},
      {"job.toml --device 99", kDevice, {"99"}}};
  const std::set<std::string> before = files();
  for (const Case& refused : cases) {
    const Outcome outcome = mica("render " + refused.arguments);
    EXPECT_EQ(outcome.code, refused.code) << refused.arguments << "\n" << outcome.err;
    for (const std::string& message : refused.messages)
      EXPECT_NE(outcome.err.find(message), std::string::npos) << refused.arguments << "\n" << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(files(), before) << refused.arguments;
  }
  const Outcome without_device = mica("render job.toml", "OCL_ICD_VENDORS=no_drivers");
  EXPECT_EQ(without_device.code, kDevice) << without_device.err;
  EXPECT_EQ(files(), before);
}

}  // namespace
}  // namespace mica::host::app::render_test
