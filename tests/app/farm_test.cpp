// What a render farm asks of one call: which frames, which are there, what happened, on which device.
#include "tests/app/farm_job.h"

namespace mica::host::app::farm_test {
namespace {

constexpr int kUsage = 2, kDevice = 3, kFile = 4;

class FarmCommand : public FarmTest {};

TEST_F(FarmCommand, TakesFramesOfItsEnvironment) {
  EXPECT_EQ(mica("render job.toml -o a.exr --quiet", "MICA_FRAMES=1-5x2").code, 0);
  EXPECT_EQ(files(), (std::set<std::string>{"job.toml", "map.exr", "a.0001.exr", "a.0001.png", "a.0003.exr",
                                            "a.0003.png", "a.0005.exr", "a.0005.png"}));
  const Outcome wrong = mica("render job.toml -o a.exr", "MICA_FRAMES=9");
  EXPECT_EQ(wrong.code, kUsage);
  EXPECT_NE(wrong.err.find("MICA_FRAMES=9: the job has frames 0 to 5"), std::string::npos) << wrong.err;
  EXPECT_EQ(mica("render job.toml -o b.exr --frames 2 --quiet", "MICA_FRAMES=9").code, 0);
}

// Whatever is wrong with what is there, it is made again, and is then what it was.
TEST_F(FarmCommand, MakesOnlyWhatIsNotFinished) {
  const std::string render = "render job.toml -o a.exr --frames 0-1 --skip-finished --quiet --json-log ";
  ASSERT_EQ(mica(render + "first.jsonl").code, 0);
  EXPECT_EQ(words("first.jsonl"), "started finished finished ended");
  ASSERT_EQ(mica(render + "second.jsonl", "MICA_DEVICE=99").code, 0) << "a device was opened for nothing";
  EXPECT_EQ(words("second.jsonl"), "started skipped skipped ended");

  const std::string good = bytes(path("a.0001.exr")), preview = bytes(path("a.0001.png"));
  std::string other_frame = bytes(path("a.0000.exr"));
  const auto expect_made = [&](const std::string& what) {
    std::filesystem::remove(path("again.jsonl"));
    ASSERT_EQ(mica(render + "again.jsonl").code, 0);
    EXPECT_EQ(words("again.jsonl"), "started skipped finished ended") << what;
    EXPECT_TRUE(bytes(path("a.0001.exr")) == good) << what;
    EXPECT_TRUE(bytes(path("a.0001.png")) == preview) << what;
  };
  write("a.0001.exr", good.substr(0, good.size() - 1)), expect_made("cut short");
  change("a.0001.exr", good.size() - 10), expect_made("changed");
  write("a.0001.exr", ""), expect_made("empty");
  write("a.0001.exr", other_frame), expect_made("another frame");
  change("a.0001.png", preview.size() / 2), expect_made("the preview changed");
  std::filesystem::remove(path("a.0001.png")), expect_made("no preview");
}

TEST_F(FarmCommand, MakesAgainWhatIsOfAnotherJobOrOtherInputs) {
  const std::string render = "render job.toml -o a.exr --frames 3 --skip-finished --quiet --json-log ";
  ASSERT_EQ(mica(render + "a.jsonl").code, 0);
  ASSERT_EQ(mica(render + "b.jsonl --set seed=2").code, 0);
  EXPECT_EQ(words("b.jsonl"), "started finished ended");
  write_map("map.exr",
            make_surface({"bumps", SpectrumSurface{32, 0.2, 4, 2}, Interpolation::bilinear}, nullptr));
  ASSERT_EQ(mica(render + "c.jsonl --set seed=2").code, 0);
  EXPECT_EQ(words("c.jsonl"), "started finished ended");
  ASSERT_EQ(mica(render + "d.jsonl --set seed=2").code, 0);
  EXPECT_EQ(words("d.jsonl"), "started skipped ended");
}

TEST_F(FarmCommand, TellsWhatHappens) {
  std::filesystem::create_directory(path("a.0001.exr"));
  ASSERT_EQ(mica("render job.toml -o a.exr --frames 0-1 --quiet --json-log l.jsonl").code, 1);
  const auto log = events("l.jsonl");
  ASSERT_EQ(words("l.jsonl"), "started finished failed ended");
  EXPECT_EQ(log[0].at("frames"), "0-1");
  EXPECT_EQ(log[0].at("range"), nlohmann::json({0, 5}));
  EXPECT_EQ(log[1].at("bytes"),
            std::filesystem::file_size(path("a.0000.exr")) + std::filesystem::file_size(path("a.0000.png")));
  EXPECT_EQ(log[1].at("audit").at("samples"), 20);
  EXPECT_EQ(log[2].at("frame"), 1);
  EXPECT_EQ(log[2].at("kind"), "file");
  EXPECT_EQ(log[3].at("code"), 1);
  // A second process adds to the log.
  EXPECT_EQ(mica("render job.toml -o b.exr --device 99 --json-log l.jsonl").code, kDevice);
  EXPECT_EQ(words("l.jsonl"), "started finished failed ended started failed");
  EXPECT_EQ(events("l.jsonl")[5].at("kind"), "device");
  // What is no log does not grow.
  const std::string job = bytes(path("job.toml"));
  EXPECT_EQ(mica("render job.toml -o b.exr --json-log job.toml").code, kFile);
  EXPECT_TRUE(bytes(path("job.toml")) == job);
}

// Processes that start at once on an empty cache: each kernel is compiled by one of them.
TEST_F(FarmCommand, CompilesOnceWhatManyNeed) {
  const std::string render = "'" MICA_PROGRAM "' render job.toml --frames 0 --quiet -o ";
  std::string together = "true; ";
  for (const char* n : {"1", "2", "3"}) together += render + n + ".exr --json-log " + n + ".jsonl & ";
  mica("--version", "unset POCL_CACHE_DIR; export MICA_CACHE_DIR=kernels; " + together + " wait;");
  int compiled = 0, used = 0;
  for (const char* n : {"1.jsonl", "2.jsonl", "3.jsonl"}) {
    std::istringstream lines(bytes(path(n)));
    for (std::string line; std::getline(lines, line);) {
      const auto event = nlohmann::json::parse(line);
      if (event.at("event") != "kernels") continue;
      compiled += event.at("compiled").get<int>(), used += event.at("of").get<int>();
    }
  }
  EXPECT_GT(compiled, 0);
  EXPECT_EQ(used, 3 * compiled);
  const std::string all = std::to_string(compiled) + " programs";
  EXPECT_TRUE(bytes(path("1.0000.exr")) == bytes(path("3.0000.exr")));
  EXPECT_TRUE(std::filesystem::exists(path("kernels/pocl")));
  const Outcome warm = mica("warm job.toml", "unset POCL_CACHE_DIR; MICA_CACHE_DIR=kernels");
  EXPECT_NE(warm.out.find(": 0 of " + all), std::string::npos) << warm.out;
  // Kernels that others could change are not run.
  std::filesystem::permissions(path("kernels"), std::filesystem::perms(0777));
  const Outcome open = mica("warm job.toml", "unset POCL_CACHE_DIR; MICA_CACHE_DIR=kernels");
  EXPECT_NE(open.out.find(": " + std::to_string(compiled) + " of " + all), std::string::npos) << open.out;
}

TEST_F(FarmCommand, ChoosesDevices) {
  const std::string check = "check job.toml";
  EXPECT_EQ(mica(check, "MICA_DEVICE=99").code, kDevice);
  EXPECT_EQ(mica(check, "MICA_DEVICE=first").code, kUsage);
  EXPECT_EQ(mica(check + " --device auto", "MICA_DEVICE=99 SLURM_LOCALID=7").code, 0);
  EXPECT_EQ(mica(check + " --device auto", "SLURM_LOCALID=x").code, kUsage);
  // The driver of a CPU has the threads that Slurm gives.
  const Outcome devices = mica("devices", "SLURM_CPUS_PER_TASK=1");
  EXPECT_NE(devices.out.find("   1 compute units"), std::string::npos) << devices.out;
}

}  // namespace
}  // namespace mica::host::app::farm_test
