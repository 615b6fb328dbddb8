#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <fstream>

#include "host/scene/scene.h"
#include "host/scene/shading.h"
#include "tests/image/folder.h"

namespace mica::host::shading_test {
namespace {

using Eigen::Vector3d;

/// A point on the plane z = 0 of which u runs along +x and v obliquely, with an interpolated normal off the
/// face's.
Hit oblique_hit() {
  Hit hit;
  hit.position.setZero();
  hit.face_normal = Vector3d::UnitZ();
  hit.normal = Vector3d(0.3, -0.2, 1).normalized();
  hit.dpdu = hit.tangent = Vector3d(2, 0, 0);
  hit.dpdv = Vector3d(0.5, 3, 0);
  return hit;
}

void expect_orthonormal(const TangentFrame& frame) {
  Eigen::Matrix3d axes;
  axes << frame.x, frame.y, frame.z;
  EXPECT_TRUE((axes.transpose() * axes).isApprox(Eigen::Matrix3d::Identity(), 1e-14));
}

TEST(TangentFrameOfAHit, IsOrthonormalAlongUOnTheSideOfV) {
  const Hit hit = oblique_hit();
  const TangentFrame frame = tangent_frame(hit, Vector3d(0.1, 0.2, 1).normalized());
  expect_orthonormal(frame);
  EXPECT_TRUE(frame.z.isApprox(hit.normal, 1e-15));
  EXPECT_NEAR(frame.x.dot(hit.normal.cross(hit.dpdu)), 0, 1e-14) << "in the plane of u and the normal";
  EXPECT_GT(frame.x.dot(hit.dpdu), 0);
  EXPECT_GT(frame.y.dot(hit.dpdv), 0);
  EXPECT_NEAR(frame.x.cross(frame.y).dot(frame.z), 1, 1e-14) << "right-handed where uv is not mirrored";
  EXPECT_TRUE(frame.on_disk(frame.z).isZero(1e-14));
}

TEST(TangentFrameOfAHit, FollowsVWhereUvIsMirrored) {
  Hit hit = oblique_hit();
  hit.dpdv = -hit.dpdv;
  const TangentFrame frame = tangent_frame(hit, Vector3d::UnitZ());
  expect_orthonormal(frame);
  EXPECT_GT(frame.x.dot(hit.dpdu), 0);
  EXPECT_GT(frame.y.dot(hit.dpdv), 0);
}

TEST(TangentFrameOfAHit, TurnsToTheEyeWhicheverWayNormalsPoint) {
  for (const double face : {1.0, -1.0})
    for (const double smooth : {1.0, -1.0})
      for (const double side : {1.0, -1.0}) {
        Hit hit = oblique_hit();
        hit.face_normal *= face;
        hit.normal *= smooth;
        const TangentFrame frame = tangent_frame(hit, Vector3d(0, 0, side));
        expect_orthonormal(frame);
        EXPECT_EQ(frame.face_normal, Vector3d(0, 0, side));
        EXPECT_TRUE(frame.z.isApprox(side * oblique_hit().normal, 1e-15));
        EXPECT_GT(frame.x.dot(hit.dpdu), 0);
        EXPECT_GT(frame.y.dot(hit.dpdv), 0);
      }
}

TEST(TangentFrameOfAHit, FallsBackOnTheFaceWhereItsNormalTurnsAway) {
  const Hit hit = oblique_hit();
  const Vector3d to_eye =
      Vector3d(-1, 0.6, 0.05).normalized();  // above the face, below the horizon of the normal
  ASSERT_LT(hit.normal.dot(to_eye), 0);
  const TangentFrame frame = tangent_frame(hit, to_eye);
  EXPECT_EQ(frame.z, hit.face_normal);
  expect_orthonormal(frame);
}

TEST(TangentFrameOfAHit, NeedsNoUv) {
  Hit hit = oblique_hit();
  hit.tangent.setZero();
  hit.dpdu.setZero();
  hit.dpdv.setZero();
  expect_orthonormal(tangent_frame(hit, Vector3d::UnitZ()));
  hit.tangent = hit.normal;
  expect_orthonormal(tangent_frame(hit, Vector3d::UnitZ()));
}

TEST(Illuminate, FallsWithTheSquareOfTheDistance) {
  const PointLight light{{1, 2, 5}, {8, 16, 24}};
  const Illumination near = illuminate(light, {1, 2, 3}), far = illuminate(light, {1, -2, 5});
  EXPECT_EQ(near.direction, Vector3d(0, 0, 1));
  EXPECT_EQ(near.distance, 2);
  EXPECT_TRUE(near.irradiance.isApprox(Color(2, 4, 6)));
  EXPECT_TRUE(far.irradiance.isApprox(Color(0.5, 1, 1.5)));
  EXPECT_EQ(illuminate(light, light.position).irradiance, Color::Zero());
}

TEST(Illuminate, ComesFromOneDirectionWithoutFalling) {
  const Illumination sun = illuminate(DirectionalLight{{0, 0, -3}, {1, 2, 3}}, {7, 7, 7});
  EXPECT_EQ(sun.direction, Vector3d(0, 0, 1));
  EXPECT_EQ(sun.distance, INFINITY);
  EXPECT_EQ(sun.irradiance, Color(1, 2, 3));
}

using InterpolatedNormals = FolderTest;

TEST_F(InterpolatedNormals, KeepLightBelowTheirHorizonOut) {
  std::ofstream(path("a.obj"))
      << "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 1 0 1\n"
         "f 1/1/1 2/2/1 3/3/1 4/4/1\n";
  SceneDescription description;
  description.materials = {MaterialDescription{}};
  description.shapes = {{MeshShape{path("a.obj")}, ""}};
  description.camera.position = {0, 0, 5};
  description.camera.up = {0, 1, 0};
  const auto query_count = [&](const Vector3d& light) {
    description.lights = {DirectionalLight{-light}};
    return Scene(description, 5, 5, 1).trace(0, 5).queries.size();
  };
  EXPECT_GT(query_count({0, 0, 1}), 0u);
  EXPECT_EQ(query_count({-1, 0, 0.5}), 0u) << "above the face, below the horizon of its normals";
  EXPECT_EQ(query_count({1, 0, -0.5}), 0u) << "above the horizon of its normals, below the face";
}

}  // namespace
}  // namespace mica::host::shading_test
