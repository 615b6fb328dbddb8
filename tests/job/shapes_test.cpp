// Placement, parts, coats and lights of a job: what they are read as, and what is refused.
#include "tests/job/job_text.h"

namespace mica::host::test::shapes_test {
namespace {

using Eigen::Vector3d;

struct ShapesOfAJob : testing::Test {
  JobFolder folder;
  std::string message_of(const std::string& text) const {
    const auto issues = folder.issues(text);
    return issues.size() == 1 ? issues[0].message : std::to_string(issues.size()) + " issues";
  }
};

TEST_F(ShapesOfAJob, HavePlacementAndParts) {
  const std::string text = replaced(kLeastJob, "type = \"sphere\"\nmaterial = \"gold\"",
                                    "type = \"jar\"\nmaterial = \"gold\"\nsize = 3\nscale = [1, 2, 3]\n"
                                    "rotate = [10, 20, 30]\ntranslate = [4, 5, 6]\n"
                                    "parts = [{ name = \"lid\", material = \"gold\" }]");
  const ShapeDescription shape = folder.load(text).scene.shapes.at(0);
  EXPECT_EQ(std::get<JarShape>(shape.geometry).size, 3);
  EXPECT_EQ(shape.placement.scale, Vector3d(1, 2, 3));
  EXPECT_EQ(shape.placement.rotate_degrees, Vector3d(10, 20, 30));
  EXPECT_EQ(shape.placement.translate, Vector3d(4, 5, 6));
  ASSERT_EQ(shape.parts.size(), 1u);
  EXPECT_EQ(shape.parts[0].part, "lid");
  EXPECT_EQ(shape.parts[0].material, "gold");
}

TEST_F(ShapesOfAJob, RefuseWhatMakesNoSense) {
  const auto with = [](const std::string& keys) {
    return replaced(kLeastJob, "type = \"sphere\"\n", "type = \"spoon\"\n" + keys + "\n");
  };
  EXPECT_EQ(message_of(with("scale = [1, 0, 1]")).rfind("shape.0.scale.1: found 0", 0), 0u);
  EXPECT_EQ(message_of(with("radius = 1")).rfind("shape.0.radius: found an unknown key", 0), 0u);
  EXPECT_EQ(message_of(with("parts = [{ name = \"lid\", material = \"tin\" }]"))
                .rfind("shape.0.parts.0.material: found \"tin\"", 0),
            0u);
}

TEST_F(ShapesOfAJob, LightsMayHaveAnExtent) {
  const std::string text = kLeastJob +
                           "[[light]]\ntype = \"sphere\"\nposition = [1, 2, 3]\nradius = 0.5\n"
                           "[[light]]\ntype = \"disk\"\nposition = [1, 2, 3]\ndirection = [0, 1, 0]\n"
                           "radius = 0.25\nintensity = [7, 8, 9]\n";
  const auto lights = folder.load(text).scene.lights;
  EXPECT_EQ(std::get<SphereLight>(lights.at(1)).radius, 0.5);
  EXPECT_EQ(std::get<DiskLight>(lights.at(2)).direction, Vector3d(0, 1, 0));
  EXPECT_EQ(std::get<DiskLight>(lights.at(2)).intensity, Color(7, 8, 9));
  EXPECT_EQ(message_of(kLeastJob + "[[light]]\ntype = \"disk\"\nposition = [1, 2, 3]\nradius = 0\n")
                .rfind("light.1.radius: found 0", 0),
            0u);
}

TEST_F(ShapesOfAJob, MaterialsMayHaveACoat) {
  const std::string text =
      replaced(kLeastJob, "surface = \"bumps\"", "surface = \"bumps\"\ncoat = { ior = 1.6 }");
  const auto coat = folder.load(text).scene.materials.at(0).coat;
  ASSERT_TRUE(coat);
  EXPECT_EQ(coat->ior, 1.6);
  EXPECT_EQ(coat->roughness, 0.02);
  EXPECT_FALSE(folder.load(kLeastJob).scene.materials.at(0).coat);
}

}  // namespace
}  // namespace mica::host::test::shapes_test
