#include "tests/job/job_text.h"

namespace mica::host::test::overrides_test {
namespace {

TEST(Overrides, ReplaceAndAddValues) {
  const JobFolder folder;
  const Job job = folder.load("[image]\nwidth = 10\n" + kLeastJob,
                              {"image.width=20", "image.height = 30", "seed=5", "camera.fov=60.5"});
  EXPECT_EQ(job.image.width, 20);
  EXPECT_EQ(job.image.height, 30);
  EXPECT_EQ(job.seed, 5u);
  EXPECT_EQ(job.scene.camera.fov_degrees, 60.5);
}

TEST(Overrides, TheLastOneWins) {
  EXPECT_EQ(JobFolder().load(kLeastJob, {"seed=5", "seed=6"}).seed, 6u);
}

TEST(Overrides, IndexArraysFromZero) {
  const JobFolder folder;
  const std::string two_lights = kLeastJob + "[[light]]\ntype = \"point\"\nposition = [1, 1, 1]\n";
  const Job job = folder.load(two_lights, {"light.1.position=[7, 8, 9]", "light.0.position.2=5"});
  EXPECT_EQ(std::get<PointLight>(job.scene.lights[0]).position, Eigen::Vector3d(0, 0, 5));
  EXPECT_EQ(std::get<PointLight>(job.scene.lights[1]).position, Eigen::Vector3d(7, 8, 9));
}

TEST(Overrides, TakeBareWordsAsStrings) {
  const JobFolder folder;
  folder.write("a-1.exr", "x");
  const Job job = folder.load(kLeastJob, {"surface.bumps.interpolation=bicubic", "background.image=a-1.exr"});
  EXPECT_EQ(job.surfaces[0].interpolation, Interpolation::bicubic);
  EXPECT_EQ(job.scene.background.path, folder.path("a-1.exr"));
}

TEST(Overrides, TakeQuotedKeysAndValues) {
  const JobFolder folder;
  const Job job =
      folder.load(kLeastJob, {"surface.\"a=b.c\".generate=\"flakes\"", "material.gold.surface='a=b.c'"});
  EXPECT_EQ(job.scene.materials[0].surface, "a=b.c");
}

TEST(Overrides, ReplaceInlineTablesAsAWhole) {
  const JobFolder folder;
  const std::string glass = replaced(kLeastJob, "\"bumps\"", "\"bumps\"\nspecular = { ior = 1.5 }");
  const Job job = folder.load(glass, {"material.gold.specular={ color = [1, 0, 0] }"});
  EXPECT_EQ(std::get<ColorFresnel>(job.scene.materials[0].specular).color, Color(1, 0, 0));
  EXPECT_EQ(std::get<DielectricFresnel>(
                folder.load(glass, {"material.gold.specular.ior=2"}).scene.materials[0].specular)
                .ior,
            2);
}

TEST(Overrides, RepairTheFile) {
  EXPECT_TRUE(JobFolder().issues("[image]\nwidth = 0\n" + kLeastJob, {"image.width=1"}).empty());
}

struct WrongOverride {
  std::string text, message;
};

class WrongOverrides : public testing::TestWithParam<WrongOverride> {};

TEST_P(WrongOverrides, NameThemselvesAsThePlace) {
  const JobFolder folder;
  const auto issues = folder.issues(kLeastJob, {GetParam().text});
  ASSERT_EQ(issues.size(), 1u) << (issues.empty() ? "" : JobError(issues).what());
  EXPECT_EQ(issues[0].file, "--set " + GetParam().text);
  EXPECT_EQ(issues[0].line, 0);
  EXPECT_EQ(issues[0].message, GetParam().message);
  EXPECT_STREQ(JobError(issues).what(), ("--set " + GetParam().text + ": " + GetParam().message).c_str());
}

const std::string kNoAssignment = "found no assignment; expected key.path=value on one line";

const std::vector<WrongOverride> kWrongOverrides = {
    {"", kNoAssignment},
    {"image.width", kNoAssignment},
    {"=3", kNoAssignment},
    {"image.width=", kNoAssignment},
    {"[image]=3", kNoAssignment},
    {"# seed=3", kNoAssignment},
    {"'seed=3", kNoAssignment},
    {"image.width=0", "image.width: found 0; expected an integer in [1, 16384]"},
    {"image.width=1280x720", "image.width: found \"1280x720\" (a string); expected an integer in [1, 16384]"},
    {"imaeg.width=1",
     "imaeg: found an unknown key; expected one of: seed, image, frames, surface, camera, material, shape, "
     "light, "
     "background, accuracy, audit (did you mean \"image\"?)"},
    {"light.1.position=[0,0,1]",
     "found \"1\" as an index into an array of 1; expected an integer from 0 below 1"},
    {"light.-1.position=[0,0,1]",
     "found \"-1\" as an index into an array of 1; expected an integer from 0 below 1"},
    {"light.x=3", "found \"x\" as an index into an array of 1; expected an integer from 0 below 1"},
    {"light.position=[0,0,1]",
     "found \"position\" as an index into an array of 1; expected an integer from 0 below 1"},
    {"shape.0.type.x=3", "found \"sphere\" (a string) in front of \"x\"; expected a table or an array"},
    {"shape=[]", "shape: found no [[shape]]; expected at least one"},
    {"material.gold.surface=none",
     "material.gold.surface: found \"none\"; expected the name of a surface, \"bumps\""},
    {"surface.two.resolution=64",
     "surface.two: found neither of \"file\" and \"generate\"; expected exactly one"},
};
INSTANTIATE_TEST_SUITE_P(Set, WrongOverrides, testing::ValuesIn(kWrongOverrides));

TEST(Overrides, BrokenTomlIsNotTakenAsAString) {
  const JobFolder folder;
  for (const std::string value : {"[1, 2", "{ior = 1.5", "\"open", "'open"}) {
    const auto issues = folder.issues(kLeastJob, {"camera.position=" + value});
    ASSERT_EQ(issues.size(), 1u) << value;
    EXPECT_NE(issues[0].message.find("Error while parsing"), std::string::npos) << issues[0].message;
  }
}

TEST(Overrides, MayNotBringInFurtherLines) {
  const JobFolder folder;
  const auto issues = folder.issues(kLeastJob, {"seed=1\naudit.samples=3"});
  ASSERT_EQ(issues.size(), 1u);
  EXPECT_EQ(issues[0].file, "--set seed=1\\x0aaudit.samples=3");
  EXPECT_EQ(issues[0].message, kNoAssignment);
}

}  // namespace
}  // namespace mica::host::test::overrides_test
