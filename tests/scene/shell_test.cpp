#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

#include "host/scene/shell.h"

namespace mica::host::shell_test {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

class Shell : public testing::Test {
 protected:
  static void SetUpTestSuite() { mesh_ = std::make_unique<TriangleMesh>(make_shell(ShellShape{})); }
  static void TearDownTestSuite() { mesh_.reset(); }

  static std::array<Vector3d, 3> corners(std::size_t triangle) {
    const auto& index = mesh_->triangles[triangle];
    return {mesh_->positions[index[0]].cast<double>(), mesh_->positions[index[1]].cast<double>(),
            mesh_->positions[index[2]].cast<double>()};
  }
  static Vector3d area_vector(std::size_t triangle) {
    const auto [a, b, c] = corners(triangle);
    return (b - a).cross(c - a) / 2;
  }

  static std::unique_ptr<TriangleMesh> mesh_;
};
std::unique_ptr<TriangleMesh> Shell::mesh_;

TEST_F(Shell, IsFiniteAndOfUnitNormals) {
  ASSERT_EQ(mesh_->normals.size(), mesh_->positions.size());
  ASSERT_EQ(mesh_->tangents.size(), mesh_->positions.size());
  ASSERT_EQ(mesh_->uvs.size(), mesh_->positions.size());
  for (std::size_t i = 0; i < mesh_->positions.size(); ++i) {
    ASSERT_TRUE(mesh_->positions[i].allFinite() && mesh_->uvs[i].allFinite()) << i;
    ASSERT_NEAR(mesh_->normals[i].norm(), 1, 1e-5) << i;
    ASSERT_NEAR(mesh_->tangents[i].norm(), 1, 1e-5) << i;
    ASSERT_NEAR(mesh_->normals[i].dot(mesh_->tangents[i]), 0, 1e-5) << i;
    ASSERT_TRUE(mesh_->uvs[i].y() >= 0 && mesh_->uvs[i].y() <= 1) << i;
  }
}

TEST_F(Shell, StandsOnTheGroundAtItsSize) {
  for (const ShellShape& shell : {ShellShape{}, ShellShape{{3, -4, 5}, 2.5, 3}}) {
    Eigen::AlignedBox3f box;
    for (const Vector3f& position : make_shell(shell).positions) box.extend(position);
    EXPECT_NEAR(box.min().z(), shell.center.z(), 1e-5);
    EXPECT_NEAR(box.sizes().z(), shell.size, 1e-5);
    EXPECT_NEAR(box.center().x(), shell.center.x(), 1e-5);
    EXPECT_NEAR(box.center().y(), shell.center.y(), 1e-5);
  }
}

TEST_F(Shell, IsClosed) {
  const TriangleMesh mesh = make_shell(ShellShape{{0, 0, 0}, 1, 1});  // the fewest turns, to be quick
  // Every edge, known by where its ends are, is run through once in each direction.
  const auto key = [](const Vector3f& p) {
    return std::array<long, 3>{std::lround(p.x() * 1e6), std::lround(p.y() * 1e6), std::lround(p.z() * 1e6)};
  };
  std::map<std::pair<std::array<long, 3>, std::array<long, 3>>, int> balance;
  for (const auto& triangle : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const auto a = key(mesh.positions[triangle[i]]), b = key(mesh.positions[triangle[(i + 1) % 3]]);
      if (a < b) ++balance[{a, b}];
      if (b < a) --balance[{b, a}];
    }
  const auto open =
      std::count_if(balance.begin(), balance.end(), [](const auto& edge) { return edge.second != 0; });
  EXPECT_EQ(open, 0);
}

TEST_F(Shell, IsTurnedOutwards) {
  double volume = 0;
  for (std::size_t i = 0; i < mesh_->triangles.size(); ++i) volume += area_vector(i).dot(corners(i)[0]) / 3;
  EXPECT_GT(volume, 0.01);
}

TEST_F(Shell, NormalsAndTangentsAreThoseOfTheSurface) {
  for (std::size_t i = 0; i < mesh_->triangles.size(); ++i) {
    const Vector3d face = area_vector(i).normalized();
    // Slivers at the ends, where a ring shrinks to a point, have lost their direction to single precision.
    if (area_vector(i).norm() < 1e-9) continue;
    const UvGradients gradients = uv_gradients(*mesh_, static_cast<std::uint32_t>(i));
    for (const std::uint32_t corner : mesh_->triangles[i]) {
      ASSERT_GT(mesh_->normals[corner].cast<double>().dot(face), 0.95) << "triangle " << i;
      ASSERT_GT(mesh_->tangents[corner].cast<double>().dot(gradients.dpdu.normalized()), 0.95)
          << "triangle " << i;
    }
    ASSERT_GT(gradients.dpdu.cross(gradients.dpdv).dot(face), 0) << "uv is mirrored on triangle " << i;
  }
}

TEST_F(Shell, HasNoVisibleFacets) {
  // A normal that is interpolated between two that differ by an angle is off by at most its square / 8.
  double largest = 0;
  for (const auto& triangle : mesh_->triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector3d a = mesh_->positions[triangle[i]].cast<double>();
      const Vector3d b = mesh_->positions[triangle[(i + 1) % 3]].cast<double>();
      // Beyond u = 13.7 the rim of the lip is as narrow as a few pixels.
      if ((a - b).norm() < 0.005 || mesh_->uvs[triangle[i]].x() > 13.7) continue;
      const double cosine = mesh_->normals[triangle[i]].dot(mesh_->normals[triangle[(i + 1) % 3]]);
      largest = std::max(largest, std::acos(std::min(1.0, cosine)));
    }
  EXPECT_LT(largest * largest / 8, 2.5e-4);  // a twentieth of a roughness of 0.005
}

TEST_F(Shell, TexelsAreSquareOnTheOuterSide) {
  int compared = 0;
  for (std::size_t i = 0; i < mesh_->triangles.size(); ++i) {
    const Eigen::Vector2d uv = mesh_->uvs[mesh_->triangles[i][0]];
    // v = 1/2 faces away from the axis; in between lies the tube proper, without its tapering and its flaring
    // end.
    if (std::abs(uv.y() - 0.5) > 0.004 || uv.x() < 4 || uv.x() > 9) continue;
    const UvGradients gradients = uv_gradients(*mesh_, static_cast<std::uint32_t>(i));
    EXPECT_NEAR(gradients.dpdu.norm() / gradients.dpdv.norm(), 1, 0.02);
    ++compared;
  }
  EXPECT_GT(compared, 100);
}

TEST_F(Shell, IsTheSameEveryTime) {
  const TriangleMesh again = make_shell(ShellShape{});
  EXPECT_EQ(again.positions, mesh_->positions);
  EXPECT_EQ(again.uvs, mesh_->uvs);
}

}  // namespace
}  // namespace mica::host::shell_test
