#include "tests/job/job_text.h"

namespace mica::host::test::glints_test {
namespace {

/// A job with one material of glints, which `keys` describe.
std::string glint_job(const std::string& keys) {
  return "[material.glitter]\nndf = \"grid\"\n" + keys +
         "\n[[shape]]\ntype = \"plane\"\nmaterial = \"glitter\"\n[[light]]\ntype = \"point\"\nposition = [0, "
         "0, 4]\n";
}

TEST(GlintJob, HasDefaultsAndNeedsNoSurface) {
  const JobFolder folder;
  const Job job = folder.load(glint_job(""));
  EXPECT_TRUE(job.surfaces.empty());
  const MaterialDescription& material = job.scene.materials.at(0);
  ASSERT_TRUE(material.glints);
  EXPECT_EQ(material.ndf, "grid");
  EXPECT_EQ(material.roughness, 0.02);
  EXPECT_EQ(material.glints->distribution, Distribution::trowbridge_reitz);
  EXPECT_EQ(material.glints->alpha, Eigen::Vector2d(0.3, 0.3));
  EXPECT_EQ(material.glints->density, 1e6);
  EXPECT_TRUE(material.glints->colors.empty());
}

TEST(GlintJob, ReadsEveryKey) {
  const JobFolder folder;
  for (const char* name : {"a.png", "b.png", "c.png", "d.png", "e.png"}) folder.write(name, "x");
  const Job job = folder.load(glint_job(R"(
distribution = "beckmann"
alpha = [0.2, 0.5]
density = 1e8
microroughness = 0.01
stretch = 4
seed = 9
masking = "cavity"
mapping = "uv"
colors = [[1, 0, 0], [1, 1, 0]]
[material.glitter.textures]
density = "a.png"
alpha = "b.png"
microroughness = "c.png"
stretch = "d.png"
color = "e.png"
)"));
  const MaterialDescription& material = job.scene.materials.at(0);
  const GlintsDescription& glints = *material.glints;
  EXPECT_EQ(glints.distribution, Distribution::beckmann);
  EXPECT_EQ(glints.alpha, Eigen::Vector2d(0.2, 0.5));
  EXPECT_EQ(glints.density, 1e8);
  EXPECT_EQ(material.roughness, 0.01);
  EXPECT_EQ(glints.stretch, 4);
  EXPECT_EQ(glints.seed, 9u);
  EXPECT_EQ(glints.masking, GlintsDescription::Masking::cavity);
  ASSERT_EQ(glints.colors.size(), 2u);
  EXPECT_EQ(glints.colors[1], Eigen::Vector3d(1, 1, 0));
  EXPECT_EQ(glints.textures.density, folder.path("a.png"));
  EXPECT_EQ(glints.textures.alpha, folder.path("b.png"));
  EXPECT_EQ(glints.textures.microroughness, folder.path("c.png"));
  EXPECT_EQ(glints.textures.stretch, folder.path("d.png"));
  EXPECT_EQ(glints.textures.color, folder.path("e.png"));
}

TEST(GlintJob, TakesOneAlphaForBoth) {
  const JobFolder folder;
  EXPECT_EQ(folder.load(glint_job("alpha = 0.15")).scene.materials[0].glints->alpha,
            Eigen::Vector2d(0.15, 0.15));
}

struct Mistake {
  std::string keys, message;
};
class GlintMistake : public testing::TestWithParam<Mistake> {};

TEST_P(GlintMistake, IsNamed) {
  const JobFolder folder;
  const std::vector<JobIssue> issues = folder.issues(glint_job(GetParam().keys));
  ASSERT_EQ(issues.size(), 1u);
  EXPECT_EQ(issues[0].line, 3);
  EXPECT_NE(issues[0].message.find(GetParam().message), std::string::npos) << issues[0].message;
}

INSTANTIATE_TEST_SUITE_P(
    GlintJob, GlintMistake,
    testing::Values(Mistake{"alpha = 0", "glitter.alpha: found 0; expected a number"},
                    Mistake{"alpha = [0.1, 0.2, 0.3]", "found an array of 3; expected an array of 2 numbers"},
                    Mistake{"density = 0.5", "glitter.density: found 0.5"},
                    Mistake{"stretch = 65", "glitter.stretch: found 65"},
                    Mistake{"distribution = \"gxx\"", "did you mean \"ggx\""},
                    Mistake{"seed = 4294967296", "expected a seed below 2^32"},
                    Mistake{"colors = []", "found an array of 0; expected an array of 1 to 8"},
                    Mistake{"colors = [[1, 0]]", "glitter.colors.0: found an array of 2"},
                    Mistake{"colors = [[1, 0, 2]]", "glitter.colors.0.2: found 2"},
                    Mistake{"roughness = 0.1", "glitter.roughness: found an unknown key"},
                    Mistake{"textures = { density = \"missing.png\" }", "found no file"},
                    Mistake{"mapping = \"triplanar\"\nstretch = 3",
                            "found glints with a direction on three planes"}));

}  // namespace
}  // namespace mica::host::test::glints_test
