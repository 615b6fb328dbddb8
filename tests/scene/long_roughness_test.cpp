// A roughness of two numbers, along u and v: the lobes that queries ask for, and what lamps add to them.
#include <gtest/gtest.h>

#include <cmath>

#include "host/base/query.h"
#include "host/scene/scene.h"

namespace mica::host::long_roughness_test {
namespace {

/// Queries of a plane that is turned about its normal, seen from above.
std::vector<GlintQuery> queries_of(const LightDescription& light, double turned_degrees, bool fits,
                                   bool takes_first_order = true) {
  SceneDescription scene;
  MaterialDescription material;
  material.name = "m";
  material.long_roughness = Eigen::Vector2d(0.03, 0.01);
  material.roughness = std::sqrt(0.0005);
  scene.materials = {material};
  ShapeDescription plane{PlaneShape{{0, 0, 0}, 4}, "m"};
  plane.placement.rotate_degrees.z() = turned_degrees;
  scene.shapes = {plane};
  scene.camera.position = {0, -0.5, 5};
  scene.camera.look_at = {0, 0, 0};
  scene.camera.fov_degrees = 5;
  scene.lights = {light};
  PixelSettings pixels;
  pixels.subpixels = 2;
  pixels.filter = PixelFilter({FilterKind::gaussian});
  pixels.fits = fits;
  pixels.takes_first_order = {takes_first_order};
  return Scene(scene, 5, 5, pixels).trace(0, 5).queries;
}

TEST(LongRoughness, LiesAlongTheMapsAxes) {
  for (const double degrees : {0.0, 40.0})
    for (const bool fits : {false, true}) {
      const std::vector<GlintQuery> queries =
          queries_of(DirectionalLight{{0, 0.1, -1}, {1, 1, 1}}, degrees, fits);
      ASSERT_GE(queries.size(), 25U);
      for (const GlintQuery& query : queries) {
        const Eigen::Matrix2d lobe = lobe_covariance(query.query);
        EXPECT_NEAR(lobe(0, 0), 9e-4, 1e-12);
        EXPECT_NEAR(lobe(1, 1), 1e-4, 1e-12);
        EXPECT_NEAR(lobe(0, 1), 0, 1e-12);
      }
    }
}

TEST(LongRoughness, IsWidenedByALamp) {
  // From straight above a disk of angular radius 0.04 adds (0.04 / 4)^2 an axis.
  for (const GlintQuery& query : queries_of(SphereLight{{0, 0, 100}, 4}, 0, true)) {
    EXPECT_NEAR(lobe_covariance(query.query)(0, 0), 9e-4 + 1e-4, 3e-6);
    EXPECT_NEAR(lobe_covariance(query.query)(1, 1), 1e-4 + 1e-4, 3e-6);
  }
}

/// Methods that take no first order see a round lobe of the same mean square; plans refuse them.
TEST(LongRoughness, IsItsRootMeanSquareForRoundLobes) {
  for (const GlintQuery& query : queries_of(DirectionalLight{{0, 0.1, -1}, {1, 1, 1}}, 0, true, false)) {
    EXPECT_FALSE(query.query.lobe_cov);
    EXPECT_NEAR(query.query.roughness * query.query.roughness, 5e-4, 1e-12);
  }
}

}  // namespace
}  // namespace mica::host::long_roughness_test
