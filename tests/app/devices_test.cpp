// Several devices share a command's work: the same bits as one, and the right words where they cannot. PoCL
// makes two devices of one machine.
#include <nlohmann/json.hpp>

#include "tests/app/command.h"

namespace mica::host::app::devices_test {
namespace {

constexpr int kUsage = 2, kDevice = 3;
constexpr char kTwo[] = "POCL_DEVICES='pthread pthread'";

const char* const kJob = R"([image]
width = 48
height = 32
filter = "gaussian"
[camera]
position = [0, -3, 2]
look_at = [0, 0, 0]
fov = 30
[surface.noise]
generate = "spectrum"
resolution = 64
rms_slope = 0.15
correlation = 8
[material.metal]
surface = "noise"
repeat = [4, 4]
roughness = 0.02
[[shape]]
type = "sphere"
radius = 0.8
material = "metal"
[[light]]
type = "point"
position = [2, -3, 4]
intensity = [50, 50, 50]
)";

class DevicesCommand : public CommandTest {
 protected:
  DevicesCommand() { write("job.toml", kJob), write_map(); }
};

TEST_F(DevicesCommand, ShareATableBitForBit) {
  write("q.npy", npy_of(query_rows(3000)));
  for (const std::string method : {"triangles", "auto --tolerance 0.01", "gaussians"}) {
    const std::string eval =
        "eval --map map.exr --queries q.npy --roughness 0.05 --ndf " + method + " --json j.json -o ";
    const Outcome one = mica(eval + "one.npy", kTwo);
    ASSERT_EQ(one.code, 0) << one.err;
    EXPECT_FALSE(nlohmann::json::parse(bytes(path("j.json"))).contains("further_devices"));
    for (const std::string devices : {"0,1", "1,0", "all"}) {
      const Outcome both = mica(eval + "both.npy --device " + devices, kTwo);
      ASSERT_EQ(both.code, 0) << both.err;
      EXPECT_EQ(bytes(path("one.npy")), bytes(path("both.npy"))) << method << " on " << devices;
      EXPECT_EQ(nlohmann::json::parse(bytes(path("j.json"))).at("further_devices").size(), 1u);
    }
  }
}

TEST_F(DevicesCommand, ShareAPictureBitForBit) {
  for (const std::string ndf : {"triangles", "auto"}) {
    const std::string render = "render job.toml --quiet --set material.metal.ndf=" + ndf + " -o ";
    ASSERT_EQ(mica(render + "one.exr", kTwo).code, 0);
    const Outcome both = mica(render + "both.exr --json j.json", std::string(kTwo) + " MICA_DEVICE=0,1");
    ASSERT_EQ(both.code, 0) << both.err;
    EXPECT_EQ(bytes(path("one.exr")), bytes(path("both.exr"))) << ndf;
  }
}

TEST_F(DevicesCommand, AreRefusedWhereTheyCannotShare) {
  write("q.npy", npy_of(query_rows(10)));
  const std::string eval =
      "eval --map map.exr --ndf triangles --queries q.npy --roughness 0.05 -o d.npy --device ";
  struct Case {
    std::string arguments;
    int code;
    std::string message;
  };
  const std::vector<Case> cases = {
      {eval + "0,0", kUsage, "--device 0,0: expected numbers"},
      {eval + "0,", kUsage, "--device 0,: expected numbers"},
      {eval + "0,x", kUsage, "--device 0,x"},
      {eval + "0,2", kDevice, "2"},
      {"check job.toml --device 0,1", kUsage, "--device 0,1: expected one device"},
      {"selftest --device all", kUsage, "--device all: expected one device"},
      {"render job.toml -o a.exr --device 0,1 --set image.samples=4 --set image.max_bounces=2", kUsage,
       "2 devices"}};
  for (const Case& refused : cases) {
    const Outcome outcome = mica(refused.arguments, kTwo);
    EXPECT_EQ(outcome.code, refused.code) << refused.arguments << "\n" << outcome.err;
    EXPECT_NE(outcome.err.find(refused.message), std::string::npos) << refused.arguments << "\n"
                                                                    << outcome.err;
  }
}

}  // namespace
}  // namespace mica::host::app::devices_test
