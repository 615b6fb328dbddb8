#include <gtest/gtest.h>

#include <cmath>

#include "host/scene/keyframes.h"

namespace mica::host::keyframes_test {
namespace {

using Eigen::Vector3d;

SceneDescription moving() {
  SceneDescription scene;
  CameraDescription far = scene.camera, near = scene.camera;
  far.position = {0, -8, 2};
  far.fov_degrees = 20;
  near.position = {0, -4, 0};
  near.fov_degrees = 40;
  scene.camera_keys = {{10, far}, {20, near}, {21, far}};
  scene.lights = {PointLight{}, DiskLight{}};
  DiskLight low, high;
  low.position = {1, 0, 1};
  high.position = {1, 0, 9};
  high.radius = 1.5;
  scene.light_keys = {{}, {{0, low}, {8, high}}};
  return scene;
}

TEST(Keyframes, AreMetAndJoinedByLines) {
  const SceneDescription scene = moving();
  EXPECT_EQ(camera_at(scene, 10).position, Vector3d(0, -8, 2));
  EXPECT_EQ(camera_at(scene, 20).position, Vector3d(0, -4, 0));
  EXPECT_TRUE(camera_at(scene, 12.5).position.isApprox(Vector3d(0, -7, 1.5)));
  EXPECT_NEAR(camera_at(scene, 12.5).fov_degrees, 25, 1e-12);
  EXPECT_TRUE(camera_at(scene, 20.25).position.isApprox(Vector3d(0, -5, 0.5)));
  EXPECT_TRUE(std::get<DiskLight>(lights_at(scene, 2)[1]).position.isApprox(Vector3d(1, 0, 3)));
  EXPECT_NEAR(std::get<DiskLight>(lights_at(scene, 2)[1]).radius, 0.75, 1e-12);
}

/// Where the sun of two keys, 4 frames apart, shines to.
Vector3d turned(const Vector3d& first, const Vector3d& last, double frame) {
  SceneDescription scene;
  scene.lights = {DirectionalLight{}};
  scene.light_keys = {{{0, DirectionalLight{first}}, {4, DirectionalLight{last}}}};
  return std::get<DirectionalLight>(lights_at(scene, frame)[0]).direction;
}

TEST(Keyframes, DirectionsTurnWhateverTheirLengths) {
  const Vector3d left(1, 0, -1), right(-1, 0, -1);
  for (const double length : {1.0, 10.0, 1e-200})
    EXPECT_TRUE(turned(length * left, right, 2).isApprox(Vector3d(0, 0, -1), 1e-12)) << length;
  // 90 degrees in 4 frames, 22.5 in each.
  EXPECT_NEAR(turned(left, 100 * right, 1).dot(left.normalized()), std::cos(M_PI / 8), 1e-12);
  EXPECT_TRUE(turned(left, 3 * left, 1).isApprox(left.normalized(), 1e-12));
}

TEST(Keyframes, ALampThatTurnsOverHasADirectionInEachFrame) {
  const Vector3d down(0.3, 0, -1), up = -2 * down;
  for (const double frame : {0.0, 1.0, 2.0, 3.0, 4.0}) {
    const Vector3d found = turned(down, up, frame);
    EXPECT_NEAR(found.normalized().dot(down.normalized()), std::cos(M_PI * frame / 4), 1e-12) << frame;
  }
}

TEST(Keyframes, StandStillBeforeAndAfter) {
  const SceneDescription scene = moving();
  EXPECT_EQ(camera_at(scene, -5).position, Vector3d(0, -8, 2));
  EXPECT_EQ(camera_at(scene, 99).position, Vector3d(0, -8, 2));
  EXPECT_EQ(std::get<DiskLight>(lights_at(scene, 9)[1]).position, Vector3d(1, 0, 9));
  EXPECT_EQ(std::get<PointLight>(lights_at(scene, 4)[0]).position, PointLight{}.position);
  EXPECT_EQ(camera_at(SceneDescription{}, 7).position, CameraDescription{}.position);
}

}  // namespace
}  // namespace mica::host::keyframes_test
