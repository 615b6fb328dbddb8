// A method from outside the library, added through the registry alone, appears wherever the library's own do.
#include "mica/method.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "host/image/image.h"
#include "host/surface/export.h"
#include "host/surface/surface.h"
#include "mica/error.h"
#include "mica/evaluator.h"
#include "mica/job.h"
#include "tests/image/folder.h"

namespace mica::method_test {
namespace {

/// D is `level` everywhere.
class Toy : public Method {
 public:
  explicit Toy(std::string name = "toy", float factor = 1) : name_(std::move(name)), factor_(factor) {}
  std::string name() const override { return name_; }
  std::string summary() const override { return "the same density everywhere"; }
  std::vector<MethodNumber> numbers() const override { return {{"level", "The density", 0.5, 0, 10}}; }
  std::unique_ptr<Densities> make(const NormalMap&, const std::vector<double>& numbers) const override {
    class Flat : public Densities {
     public:
      explicit Flat(float level) : level_(level) {}
      void evaluate(Span<const Query> queries, Span<float> densities) const override {
        for (std::size_t n = 0; n < queries.size; ++n) densities[n] = level_;
      }

     private:
      float level_;
    };
    return std::make_unique<Flat>(factor_ * static_cast<float>(numbers[0]));
  }

 private:
  std::string name_;
  float factor_;
};

Methods with_toy() {
  Methods methods;
  methods.add(std::make_shared<Toy>());
  return methods;
}

class OutsideMethod : public host::FolderTest {
 protected:
  OutsideMethod() {
    std::filesystem::current_path(folder_);
    const host::Surface surface = host::make_surface(
        {"test", host::SpectrumSurface{32, 0.2, 6, 1}, host::Interpolation::bilinear}, nullptr);
    host::Image image;
    image.width = surface.width(), image.height = surface.height();
    image.channels = {"R", "G", "B"}, image.pixels = host::to_signed_rgb(surface);
    host::write_exr("map.exr", image);
    std::ofstream("q.csv") << "u,v,cuu,cuv,cvv,s,t\n0.5,0.5,1e-3,0,1e-3,0.1,0\n0.1,0.2,1e-3,0,1e-3,0,0\n";
  }

  /// The command line with the toy; what it wrote to standard output.
  static int run(const std::vector<std::string>& words, std::string* out = nullptr) {
    std::vector<const char*> arguments = {"mica"};
    for (const std::string& word : words) arguments.push_back(word.c_str());
    testing::internal::CaptureStdout();
    const int code = run_command(static_cast<int>(arguments.size()), arguments.data(), with_toy());
    const std::string text = testing::internal::GetCapturedStdout();
    if (out) *out = text;
    return code;
  }

  static std::string text_of(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
};

TEST_F(OutsideMethod, AnswersInEvalWithItsSettings) {
  ASSERT_EQ(run({"eval", "--map", "map.exr", "--ndf", "toy", "--level", "3", "--roughness", "0.1",
                 "--queries", "q.csv", "-o", "d.npy"}),
            0);
  const std::string bytes = text_of("d.npy");
  float densities[2];
  std::memcpy(densities, bytes.data() + bytes.size() - sizeof densities, sizeof densities);
  EXPECT_EQ(densities[0], 3);
  EXPECT_EQ(densities[1], 3);
  EXPECT_EQ(run({"eval", "--map", "map.exr", "--ndf", "toy", "--level", "30", "--roughness", "0.1",
                 "--queries", "q.csv", "-o", "e.npy"}),
            2);
  EXPECT_FALSE(std::filesystem::exists("e.npy"));
}

TEST_F(OutsideMethod, RendersInAJob) {
  std::ofstream("job.toml") << R"(
    image = { width = 16, height = 12, subpixels = 1, aovs = ["ndf"] }
    camera = { position = [0, -3, 2], look_at = [0, 0, 0] }
    surface.noise = { generate = "spectrum", resolution = 32 }
    material.flat = { surface = "noise", ndf = "toy", level = 2 }
    shape = [{ type = "plane", material = "flat" }]
    light = [{ type = "point", position = [0, 0, 3], intensity = [9, 9, 9] }]
  )";
  std::string plan;
  ASSERT_EQ(run({"check", "job.toml"}, &plan), 0);
  EXPECT_NE(plan.find("toy on surface noise"), std::string::npos) << plan;
  const Job job = Job::load("job.toml", {}, with_toy());
  const std::vector<float> densities = Renderer(Device(), job).render().channel("ndf.Y");
  EXPECT_EQ(densities[8 * 16 + 8], 2);
  EXPECT_THROW(Job::load("job.toml"), UsageError);  // without the registry nobody knows it
  EXPECT_THROW(Job::load("job.toml", {"material.flat.level=11"}, with_toy()), UsageError);
  // Its keys may stay when another method is tried, and are among those that a mistake is answered with.
  EXPECT_NO_THROW(Job::load("job.toml", {"material.flat.ndf=\"triangles\""}, with_toy()));
  try {
    Job::load("job.toml", {"material.flat.ndf=\"triangles\"", "material.flat.nothing=1"}, with_toy());
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("level"), std::string::npos) << error.what();
  }
}

TEST_F(OutsideMethod, IsMeasuredAndTested) {
  std::string table;
  ASSERT_EQ(run({"bench", "tiny", "--quiet", "--json", "bench.json"}, &table), 0);
  EXPECT_NE(table.find("toy"), std::string::npos);
  EXPECT_NE(text_of("bench.json").find("\"toy\""), std::string::npos);
}

TEST_F(OutsideMethod, IsAskedTheHardCases) {
  std::string table;
  run({"selftest", "--json", "selftest.json"}, &table);
  const nlohmann::json cases = nlohmann::json::parse(text_of("selftest.json")).at("hard_cases");
  const auto asked = std::count_if(
      cases.begin(), cases.end(), [](const nlohmann::json& entry) { return entry.at("evaluator") == "toy"; });
  EXPECT_GT(asked, 10) << "and found to be an approximation, or refused";
}

TEST_F(OutsideMethod, IsToldWithWhatItCanBeAskedFor) {
  const MethodInfo toy = with_toy().info("toy");
  EXPECT_EQ(toy.summary, "the same density everywhere");
  EXPECT_TRUE(toy.needs_map && toy.has_densities && !toy.has_brdf && !toy.keeps_tolerance);
  const MethodInfo cavities = Methods().info("cavities"), grid = Methods().info("grid");
  EXPECT_TRUE(cavities.needs_map && !cavities.has_densities && cavities.has_brdf);
  EXPECT_TRUE(!grid.needs_map && grid.has_densities && grid.has_brdf);
  EXPECT_TRUE(Methods().info("auto").keeps_tolerance);
  EXPECT_THROW(Methods().info("toy"), UsageError);
}

TEST_F(OutsideMethod, IsRefusedWhereItIsWrong) {
  Methods methods = with_toy();
  EXPECT_THROW(methods.add(nullptr), UsageError);
  EXPECT_THROW(methods.add(std::make_shared<Toy>()), UsageError);             // the name is taken
  EXPECT_THROW(methods.add(std::make_shared<Toy>("triangles")), UsageError);  // by the library
  EXPECT_THROW(methods.add(std::make_shared<Toy>("No Word")), UsageError);
  methods.add(std::make_shared<Toy>("negative", -1.0F));
  const NormalMap map = NormalMap::generate("spectrum", {{"resolution", 32}});
  const Evaluator negative(Device(), map, "negative", {}, methods);
  EXPECT_THROW(negative.evaluate(std::vector<Query>(1)), DeviceError);
  Query turning;
  turning.turn.su = 1;
  const Evaluator toy(Device(), map, "toy", {}, methods);
  EXPECT_THROW(toy.evaluate(std::vector<Query>{turning}), UsageError) << "it would not know of the turn";
  EXPECT_EQ(methods.settings_of("toy").size(), 1u);
  EXPECT_THROW(methods.settings_of("none"), UsageError);
}

}  // namespace
}  // namespace mica::method_test
