// Jar, spoon and fork: closed where they should be, turned outwards, standing where they are put.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "host/scene/curve.h"
#include "host/scene/fork.h"
#include "host/scene/geometry.h"
#include "host/scene/jar.h"
#include "host/scene/outline.h"
#include "host/scene/spoon.h"
#include "mica/error.h"

namespace mica::host::bodies_test {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

Eigen::AlignedBox3f box_of(const TriangleMesh& mesh) {
  Eigen::AlignedBox3f box;
  for (const Vector3f& position : mesh.positions) box.extend(position);
  return box;
}

void expect_sound(const TriangleMesh& mesh) {
  ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
  ASSERT_EQ(mesh.tangents.size(), mesh.positions.size());
  ASSERT_EQ(mesh.uvs.size(), mesh.positions.size());
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    ASSERT_TRUE(mesh.positions[i].allFinite() && mesh.uvs[i].allFinite()) << i;
    ASSERT_NEAR(mesh.normals[i].norm(), 1, 1e-5) << i;
    ASSERT_LT(std::abs(mesh.normals[i].dot(mesh.tangents[i])), 1e-5) << i;
  }
  int against = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vector3d face = (mesh.positions[b] - mesh.positions[a])
                              .cast<double>()
                              .cross((mesh.positions[c] - mesh.positions[a]).cast<double>());
    const Vector3d smooth = (mesh.normals[a] + mesh.normals[b] + mesh.normals[c]).cast<double>();
    against += face.dot(smooth) <= 0;
  }
  // At the tips, where triangles are slivers, a normal may lag behind.
  EXPECT_LE(against, 1e-3 * static_cast<double>(mesh.triangles.size()));
}

/// Six times the volume inside; negative when a closed surface is turned inwards.
double volume6(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    sum += mesh.positions[a].cast<double>().dot(
        mesh.positions[b].cast<double>().cross(mesh.positions[c].cast<double>()));
  return sum;
}

TEST(Spoon, IsABodyOnTheTable) {
  const TriangleMesh mesh = make_spoon({{1, 2, 3}, 2});
  expect_sound(mesh);
  const auto box = box_of(make_spoon({{0, 0, 0}, 2}));
  EXPECT_NEAR(box.sizes().x(), 2, 1e-5);
  EXPECT_GT(box.min().z(), -0.005);
  EXPECT_LT(box.min().z(), 0.03);
  EXPECT_NEAR(box.center().y(), 0, 1e-6);
  EXPECT_GT(volume6(make_spoon({{0, 0, 0}, 2})), 0);
  EXPECT_NEAR((box_of(mesh).min() - box.min() - Vector3f(1, 2, 3)).norm(), 0, 1e-5);
}

TEST(Spoon, ItsBowlIsHollow) {
  const Geometry spoon({{SpoonShape{{0, 0, 0}, 1}, ""}});
  const auto height = [&](double x, double y) {
    const auto hit = spoon.intersect({{x, y, 1}, {0, 0, -1}});
    return hit ? hit->position.z() : NAN;
  };
  EXPECT_LT(height(0.335, 0), height(0.335, 0.1) - 0.03);
  EXPECT_TRUE(std::isnan(height(0.335, 0.13)));
  EXPECT_TRUE(std::isnan(height(0, 0.03)));
}

TEST(Fork, HasFourTines) {
  const TriangleMesh mesh = make_fork({{0, 0, 0}, 1});
  expect_sound(mesh);
  EXPECT_NEAR(box_of(mesh).sizes().x(), 1, 1e-5);
  EXPECT_GT(box_of(mesh).min().z(), -0.005);
  EXPECT_GT(volume6(mesh), 0);
  const Geometry fork({{ForkShape{{0, 0, 0}, 1}, ""}});
  int entered = 0;
  bool inside = false;
  for (double y = -0.08; y < 0.08; y += 0.001) {
    const bool hit = fork.intersect({{0.43, y, 1}, {0, 0, -1}}).has_value();
    entered += hit && !inside;
    inside = hit;
  }
  EXPECT_EQ(entered, 4);
}

TEST(Jar, HasABodyAndALid) {
  const TriangleMesh mesh = make_jar({{0, 0, 0}, 1});
  expect_sound(mesh);
  EXPECT_EQ(mesh.parts, (std::vector<std::string>{"body", "lid"}));
  ASSERT_EQ(mesh.part_of_triangle.size(), mesh.triangles.size());
  const auto box = box_of(mesh);
  EXPECT_NEAR(box.min().z(), 0, 1e-6);
  EXPECT_NEAR(box.max().z(), 1, 1e-6);
  const Geometry jar({{JarShape{{0, 0, 0}, 1}, ""}});
  EXPECT_EQ(jar.parts(0), mesh.parts);
  EXPECT_EQ(jar.intersect({{0.03, -0.02, 3}, {0, 0, -1}})->part, 1u);
  EXPECT_EQ(jar.intersect({{0.01, -3, 0.3}, {0, 1, 0}})->part, 0u);
  EXPECT_EQ(jar.intersect({{0.01, -3, 0.8}, {0, 1, 0}})->part, 1u);
}

// An outline's arcs touch both their sides: its direction and normal never jump.
TEST(Outline, IsSmoothAtRoundedCorners) {
  const auto points =
      rounded_outline({{{0, 0}, 0}, {{1, 0}, 0.2}, {{1, 1}, 0.3}, {{0.2, 1.1}, 0.1}, {{0.4, 2}, 0}});
  for (std::size_t n = 1; n < points.size(); ++n) {
    const Eigen::Vector2d step = points[n].position - points[n - 1].position;
    EXPECT_NEAR(points[n].normal.norm(), 1, 1e-12);
    EXPECT_GT(points[n].normal.dot(points[n - 1].normal), 0.99) << n;
    if (step.norm() > 1e-9) {
      const Eigen::Vector2d middle = (points[n].normal + points[n - 1].normal).normalized();
      EXPECT_LT(std::abs(step.normalized().dot(middle)), 1e-6) << n;
    }
  }
  // A quarter circle of radius 0.2 cuts (2 - pi / 2) 0.2 off the corner.
  double length = 0;
  const auto corner = rounded_outline({{{0, 0}, 0}, {{1, 0}, 0.2}, {{1, 1}, 0}});
  for (std::size_t n = 1; n < corner.size(); ++n)
    length += (corner[n].position - corner[n - 1].position).norm();
  EXPECT_NEAR(length, 2 - (2 - 3.14159265358979 / 2) * 0.2, 1e-4);
}

TEST(Curve, PassesThroughItsPoints) {
  const Curve curve({{0, 1}, {1, 3}, {3, -2}, {4, -2}});
  EXPECT_EQ(curve.at(-1), 1);
  EXPECT_EQ(curve.at(9), -2);
  EXPECT_NEAR(curve.at(1), 3, 1e-12);
  EXPECT_NEAR(curve.at(3), -2, 1e-12);
  EXPECT_NEAR(curve.at(1 - 1e-7), curve.at(1 + 1e-7), 1e-5);
  const Curve line({{0, 0}, {1, 2}, {4, 8}});
  for (const double x : {0.2, 0.9, 1.5, 3.7}) EXPECT_NEAR(line.at(x), 2 * x, 1e-12);
}

TEST(Bodies, RefuseWhatMakesNoSense) {
  EXPECT_THROW(make_spoon({{0, 0, 0}, 0}), UsageError);
  EXPECT_THROW(make_fork({{0, NAN, 0}, 1}), UsageError);
  EXPECT_THROW(make_jar({{0, 0, 0}, -1}), UsageError);
}

}  // namespace
}  // namespace mica::host::bodies_test
