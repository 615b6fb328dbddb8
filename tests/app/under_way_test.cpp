// What happens around the work: outputs that cannot or must not be written, lost streams, signals, damaged
// caches.
#include <sys/stat.h>

#include "tests/app/command.h"

namespace mica::host::app::under_way_test {
namespace {

namespace fs = std::filesystem;
constexpr int kUsage = 2, kFile = 4;
const std::string kSpectrum = "map spectrum --resolution 16 -o ";

class UnderWay : public CommandTest {
 protected:
  UnderWay() {
    write_map("wood.exr", spectrum());
    write("job.toml", R"(image = { width = 16, height = 16, subpixels = 1 }
surface.m = { file = "wood.exr", encoding = "signed" }
material.a = { surface = "m", roughness = 0.1 }
shape = [{ type = "plane", material = "a" }]
light = [{ type = "point", position = [0, 0, 2] }]
)");
  }
};

TEST_F(UnderWay, OutputsThatAreInputsAreRefusedBeforeWork) {
  write("q.npy", npy_of(query_rows(2)));
  fs::create_symlink("wood.exr", path("link.exr"));
  fs::create_hard_link(path("wood.exr"), path("hard.png"));
  const std::string map = bytes(path("wood.exr")), queries = bytes(path("q.npy"));
  for (const std::string& arguments : std::vector<std::string>{
           "render job.toml -o wood.exr", "render job.toml -o ./sub/../link.exr",
           "render job.toml -o hard.exr",  // its preview
           "render job.toml -o a.exr --json job.toml", "check job.toml --json wood.exr",
           "eval --map wood.exr --ndf reference --roughness 0.1 --queries q.npy -o q.npy",
           "ndf --map wood.exr --ndf reference --roughness 0.1 --center 0,0 --sigma 1 -o wood.exr",
           "map layers --layer wood.exr -o wood.exr"}) {
    const Outcome outcome = mica(arguments);
    EXPECT_EQ(outcome.code, kUsage) << arguments << outcome.err;
    EXPECT_NE(outcome.err.find("is an input"), std::string::npos) << outcome.err;
  }
  EXPECT_EQ(mica("render job.toml -o a.exr --json a.png").code, kUsage);
  EXPECT_TRUE(bytes(path("wood.exr")) == map);
  EXPECT_TRUE(bytes(path("q.npy")) == queries);
  EXPECT_FALSE(fs::exists(path("a.exr")));
}

TEST_F(UnderWay, LinksAreFollowedAndModesKept) {
  fs::create_directory(path("store"));
  fs::create_symlink("store/real.exr", path("dangling.exr"));
  EXPECT_EQ(mica(kSpectrum + "dangling.exr").code, 0);
  EXPECT_TRUE(fs::is_symlink(path("dangling.exr")));
  EXPECT_GT(fs::file_size(path("store/real.exr")), 100u);
  fs::permissions(path("store/real.exr"), fs::perms(0600));
  EXPECT_EQ(mica(kSpectrum + "dangling.exr").code, 0);
  EXPECT_EQ(fs::status(path("store/real.exr")).permissions(), fs::perms(0600));
  fs::permissions(path("store/real.exr"), fs::perms(0444));
  EXPECT_EQ(mica(kSpectrum + "dangling.exr").code, kFile);
}

TEST_F(UnderWay, WhatCannotBeWrittenIsFoundFirst) {
  std::string deep;
  for (int n = 0; n < 2100; ++n) deep += "d/";
  EXPECT_EQ(mica(kSpectrum + deep + "a.exr").code, kFile);
  const Outcome device = mica("render job.toml -o a.exr --json /dev/null");
  EXPECT_EQ(device.code, kFile);
  EXPECT_FALSE(fs::exists(path("a.exr"))) << "found after the picture was made";
  EXPECT_EQ(
      mica("ndf --map none.exr --ndf smooth --center 0,0 --sigma 1 --roughness .1 -o new/er/x.exr").code,
      kFile);
  EXPECT_FALSE(fs::exists(path("new"))) << "a folder for nothing";
}

TEST_F(UnderWay, LostLogsEndNoWorkAndLostResultsAreErrors) {
  EXPECT_EQ(mica("render job.toml -o a.exr; echo $? > code; exit", "exec 2>/dev/full;").code, 0);
  EXPECT_EQ(bytes(path("code")), "0\n");
  EXPECT_EQ(mica("render job.toml -o b.exr 2>&-; echo $? > code; true").code, 0);
  EXPECT_EQ(bytes(path("code")), "0\n");
  EXPECT_TRUE(fs::exists(path("b.exr")));
  for (const std::string command : {"check job.toml", "devices", "--help", "--version"})
    for (const std::string stream : {">/dev/full", ">&-"}) {
      mica(command + " " + stream + "; echo $? > code; true");
      EXPECT_EQ(bytes(path("code")), "4\n") << command << stream;
    }
}

TEST_F(UnderWay, SignalsEndAlsoWhatLooksForNone) {
  for (const auto& [signal, code] : {std::pair<std::string, int>{"TERM", 143}, {"INT", 130}}) {
    // Synthesis, which is long: it has not begun before its folder is there.
    const std::string when_it_works =
        "for n in $(seq 600); do [ -d made ] && break; sleep 0.05; done; sleep 0.2; ";
    const Outcome outcome = mica("map scratches --resolution 8192 -o made/m.exr & " + when_it_works +
                                     "kill -" + signal + " $!; wait $!",
                                 "true;");  // so that the program alone goes to the background
    EXPECT_EQ(outcome.code, code) << outcome.err;
    EXPECT_FALSE(fs::exists(path("made")));
  }
}

TEST_F(UnderWay, DamagedCachesAreBuiltAgain) {
  const std::string with_cache = "XDG_CACHE_HOME=cache POCL_CACHE_DIR=pocl";
  const auto render = [&] {
    fs::remove_all(path("pocl"));
    return mica("render job.toml -o a.exr --quiet", with_cache).code;
  };
  ASSERT_EQ(render(), 0);
  EXPECT_EQ(fs::status(path("cache/mica")).permissions(), fs::perms(0700));
  std::string binary;
  for (const auto& entry : fs::directory_iterator(path("cache/mica")))
    if (entry.path().extension() == ".bin") binary = entry.path().string();
  ASSERT_NE(binary, "");
  const std::string good = bytes(binary);
  std::string flipped = good;
  flipped[good.size() / 2] = static_cast<char>(flipped[good.size() / 2] ^ 0x10);
  for (const std::string& bad : {good.substr(0, good.size() / 2), flipped, good + "x", std::string("x")}) {
    std::ofstream(binary, std::ios::binary) << bad;
    EXPECT_EQ(render(), 0);
    EXPECT_EQ(bytes(binary).size(), good.size()) << "not stored again";
  }
}

TEST_F(UnderWay, TemporariesOfTheDeadAreRemoved) {
  const Outcome host = mica("", "hostname > host; true;");
  std::string name = bytes(path("host"));
  name = name.substr(0, name.find('\n'));
  write(".mica-" + name + "-99999999-0.tmp", "x");  // above any process number
  write(".mica-another-99999999-0.tmp", "x");
  EXPECT_EQ(mica(kSpectrum + "a.exr").code, 0);
  EXPECT_FALSE(fs::exists(path(".mica-" + name + "-99999999-0.tmp")));
  EXPECT_TRUE(fs::exists(path(".mica-another-99999999-0.tmp")));
}

TEST_F(UnderWay, MessagesAreBearable) {
  write("t.obj", "\033]0;title\007 1 2\n");
  std::string job = bytes(path("job.toml"));
  write("mesh.toml", job.replace(job.find("type = \"plane\""), 14, "type = \"mesh\", file = \"t.obj\""));
  const Outcome outcome = mica("render mesh.toml -o a.exr --quiet");
  EXPECT_EQ(outcome.code, kFile);
  EXPECT_EQ(outcome.err.find('\033'), std::string::npos) << outcome.err;
  std::string many = bytes(path("job.toml"));
  for (int n = 0; n < 50000; ++n) many += "q" + std::to_string(n) + " = 1\n";
  write("many.toml", many);
  const Outcome listed = mica("check many.toml");
  EXPECT_EQ(listed.code, kUsage);
  EXPECT_LT(listed.err.size(), 40000u);
}

}  // namespace
}  // namespace mica::host::app::under_way_test
