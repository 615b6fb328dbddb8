// Lights with an extent: what they send, how they spread the half vector, and the shadows that they cast.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "host/base/constants.h"
#include "host/scene/camera.h"
#include "host/scene/scene.h"
#include "host/scene/shading.h"
#include "tests/scene/pixel_radiance.h"

namespace mica::host::lights_test {
namespace {

using Eigen::Vector3d;

// The irradiance of a uniform disk on a small patch on its axis that faces it: kPi L sin^2 of its angular
// radius [any text on radiometry], L = I / (kPi r^2).
TEST(AreaLights, IrradianceTendsToThatOfThePoint) {
  const SphereLight sphere{{0, 0, 5}, 0.3, {7, 7, 7}};
  const DiskLight disk{{0, 0, 5}, {0, 0, -2}, 0.3, {7, 7, 7}};
  for (const LightDescription& light : {LightDescription(sphere), LightDescription(disk)}) {
    const Illumination seen = illuminate(light, {0, 0, 0});
    EXPECT_NEAR(seen.irradiance[0], 7.0 / 25, 1e-12);
    EXPECT_NEAR((seen.direction - Vector3d(0, 0, 1)).norm(), 0, 1e-12);
  }
  // A disk is as bright as its foreshortened area, and dark from behind.
  const Illumination aside = illuminate(disk, {0, 4, 1});
  EXPECT_NEAR(aside.irradiance[0], 7.0 / 32 * std::sqrt(0.5), 1e-12);
  EXPECT_EQ(illuminate(disk, {0, 0, 7}).irradiance[0], 0);
}

// Brute force: half vectors of light from points of the light, their variance on the disk of the surface.
TEST(AreaLights, HalfVectorsSpreadAsTheirPointsDo) {
  const SphereLight light{{1, 0.5, 4}, 0.2, {1, 1, 1}};
  for (const Vector3d& eye : {Vector3d(0.2, 0.1, 1), Vector3d(-0.8, -0.6, 1), Vector3d(0.5, -1.2, 0.8)}) {
    const Vector3d to_eye = eye.normalized();
    const Illumination seen = illuminate(light, {0, 0, 0});
    const Vector3d middle = (to_eye + seen.direction).normalized();
    const Vector3d x = middle.unitOrthogonal(), y = middle.cross(x);
    constexpr int steps = 40;
    Eigen::Vector2d sum(0, 0);
    double squares = 0;
    for (int a = 0; a < steps; ++a)
      for (int b = 0; b < steps; ++b) {
        const LightRay ray = light_ray(light, {0, 0, 0}, {(a + 0.5) / steps, (b + 0.5) / steps});
        const Vector3d half = (to_eye + ray.direction).normalized();
        const Eigen::Vector2d on_disk(half.dot(x), half.dot(y));
        sum += on_disk;
        squares += on_disk.squaredNorm();
      }
    const double count = steps * steps, variance = (squares / count - (sum / count).squaredNorm()) / 2;
    EXPECT_NEAR(half_vector_variance(seen.variance, seen.direction.dot(middle)), variance, 0.02 * variance);
  }
}

TEST(AreaLights, WidenTheRoughnessOfQueries) {
  SceneDescription scene;
  MaterialDescription material;
  material.name = "m";
  material.roughness = 0.01;
  scene.materials = {material};
  scene.shapes = {{PlaneShape{{0, 0, 0}, 4}, "m"}};
  scene.camera.position = {0, -0.01, 5};
  scene.camera.look_at = {0, 0, 0};
  const auto roughness_under = [&](const LightDescription& light) {
    scene.lights = {light};
    const TracedRows rows = Scene(scene, 9, 9, 1).trace(4, 1);
    return rows.queries.at(rows.queries.size() / 2).query.roughness;
  };
  EXPECT_EQ(roughness_under(PointLight{{0, 0, 10}}), 0.01);
  // Half vectors turn half as far: from straight above, a disk of angular radius 0.04 adds (0.04 / 4)^2.
  EXPECT_NEAR(roughness_under(SphereLight{{0, 0, 10}, 0.4}), std::sqrt(2) * 0.01, 1e-5);
  EXPECT_NEAR(roughness_under(DiskLight{{0, 0, 10}, {0, 0, -1}, 0.4}), std::sqrt(2) * 0.01, 2e-5);
  EXPECT_LE(roughness_under(SphereLight{{0, 0, 10}, 9.99}), 1);
}

// A half plane hides half of the light at its edge, and all or nothing away from the penumbra.
TEST(AreaLights, PenumbraIsHalfLitInItsMiddle) {
  SceneDescription scene;
  MaterialDescription material;
  material.name = "m";
  material.diffuse = {1, 1, 1};
  scene.materials = {material};
  ShapeDescription screen{PlaneShape{{50, 0, 1}, 100}, "m"};
  scene.shapes = {{PlaneShape{{0, 0, 0}, 200}, "m"}, screen};
  scene.lights = {DiskLight{{0, 0, 2}, {0, 0, -1}, 0.1, {kPi, kPi, kPi}}};
  // From below the screen, so that it hides nothing: a strip of the ground across its edge, 1 wide.
  scene.camera.position = {0, -2, 0.9};
  scene.camera.look_at = {0, 0, 0};
  scene.camera.fov_degrees = 0.4;
  const int width = 200;
  const PinholeCamera camera(scene.camera, width, 3);
  const TracedRows rows = Scene(scene, width, 3, 4).trace(1, 1);
  const std::vector<Eigen::Vector3f> radiance = pixel_radiance(rows);
  double penumbra = 0;
  int in_penumbra = 0;
  for (int column = 0; column < width; ++column) {
    const CameraRay ray = camera.ray(column + 0.5, 1.5);
    const Vector3d p = ray.origin - ray.origin.z() / ray.direction.z() * ray.direction;
    const double cosine = 2 / std::sqrt(4 + p.squaredNorm());
    const double full = std::pow(cosine, 4) / 4;  // what 1 W/sr gives from 2 away
    const double lit = radiance[static_cast<std::size_t>(column)].x() / full;
    if (p.x() < -0.12) {
      EXPECT_NEAR(lit, 1, 1e-3) << p.x();
    }
    if (p.x() > 0.12) {
      EXPECT_EQ(lit, 0) << p.x();
    }
    if (std::abs(p.x()) < 0.02) penumbra += lit, ++in_penumbra;
  }
  ASSERT_GT(in_penumbra, 1);
  EXPECT_NEAR(penumbra / in_penumbra, 0.5, 0.1);
}

}  // namespace
}  // namespace mica::host::lights_test
