#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "host/base/symmetric_matrix.h"
#include "host/scene/footprint.h"
#include "host/scene/geometry.h"

namespace mica::host::footprint_test {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

Matrix2d rotation(double angle) {
  return Eigen::Rotation2Dd(angle).toRotationMatrix();
}

Matrix2d differentials(double x_axis, double y_axis, double angle) {
  return rotation(angle) * Vector2d(x_axis, y_axis).asDiagonal() * rotation(0.4);
}

/// Compares with the uv that neighbouring rays find, at every image position where they meet the same face.
/// Returns how many positions were compared.
int compare_with_neighbours(const ShapeDescription& shape, double relative_tolerance) {
  CameraDescription description;
  description.position = {0.3, -3.2, 1.4};
  description.look_at = {0, 0, 0.3};
  const PinholeCamera camera(description, 64, 36);
  const Geometry geometry({shape});
  const double h = 1e-4;
  int compared = 0;
  for (double y = 0.7; y < 36; y += 1.3)
    for (double x = 0.3; x < 64; x += 1.7) {
      const auto hit_at = [&](double dx, double dy) {
        const CameraRay ray = camera.ray(x + dx, y + dy);
        return geometry.intersect({ray.origin, ray.direction});
      };
      const auto hit = hit_at(0, 0), left = hit_at(-h, 0), right = hit_at(h, 0), up = hit_at(0, -h),
                 down = hit_at(0, h);
      if (!hit || !left || !right || !up || !down) continue;
      Matrix2d expected;
      expected << (right->uv - left->uv) / (2 * h), (down->uv - up->uv) / (2 * h);
      const bool same_triangle = left->dpdu == hit->dpdu && right->dpdu == hit->dpdu &&
                                 up->dpdu == hit->dpdu && down->dpdu == hit->dpdu;
      const bool is_mesh = std::holds_alternative<ShellShape>(shape.geometry);
      if ((is_mesh && !same_triangle) || expected.norm() > 10) continue;  // across an edge, across u = 1
      const Matrix2d found = uv_differentials(camera.ray(x, y), *hit);
      EXPECT_NEAR((found - expected).norm(), 0, relative_tolerance * expected.norm()) << x << " " << y;
      ++compared;
    }
  return compared;
}

TEST(UvDifferentials, AreThoseOfNeighbouringRays) {
  EXPECT_GT(compare_with_neighbours({PlaneShape{{0, 0, 0.1}, 6}, ""}, 1e-7), 200);
  // The sphere curves away from its tangent plane: second order in h, growing towards the silhouette.
  EXPECT_GT(compare_with_neighbours({SphereShape{{0, 0, 0.4}, 0.9}, ""}, 2e-5), 100);
  EXPECT_GT(compare_with_neighbours({ShellShape{}, ""}, 1e-6), 100);
}

TEST(UvDifferentials, AreFiniteEdgeOnAndWhereUvIsDegenerate) {
  Hit hit;
  hit.t = 2;
  hit.face_normal = hit.normal = Eigen::Vector3d::UnitZ();
  hit.dpdu = Eigen::Vector3d::UnitX();
  hit.dpdv = Eigen::Vector3d::UnitY();
  const CameraRay edge_on{{0, 0, 0}, {1, 0, 0}, {0, 0.01, 0}, {0, 0, 0.01}};
  EXPECT_TRUE(uv_differentials(edge_on, hit).allFinite());
  hit.dpdu.setZero();
  hit.dpdv.setZero();
  EXPECT_EQ(uv_differentials(edge_on, hit), Matrix2d::Zero());
}

TEST(FootprintCovariance, IsTheFilterPushedThrough) {
  const Matrix2d duv = differentials(0.02, 0.003, 1.1);
  const Matrix2d covariance = footprint_covariance(duv, 0.5);
  EXPECT_TRUE(covariance.isApprox(0.25 * duv * duv.transpose(), 1e-14));
  const PrincipalAxes axes = principal_axes(covariance);
  EXPECT_NEAR(std::sqrt(axes.eigenvalues[1]), 0.01, 1e-12);
  EXPECT_NEAR(std::sqrt(axes.eigenvalues[0]), 0.0015, 1e-12);
}

TEST(FootprintCovariance, ShortensAxesOfMoreThanAHundredToOne) {
  for (const double major : {1.0, 1e3, 1e12})
    for (const double angle : {0.0, 0.3, 1.5707963267948966, 2.5}) {
      const PrincipalAxes axes = principal_axes(footprint_covariance(differentials(major, 1e-3, angle), 1));
      // Rounding has already moved the minor axis of the longest ones.
      EXPECT_NEAR(std::sqrt(axes.eigenvalues[0]), 1e-3, major < 1e9 ? 1e-9 : 1e-3);
      EXPECT_NEAR(axes.eigenvalues[1] / axes.eigenvalues[0], 1e4, 1);
      const Vector2d direction = axes.eigenvectors.col(1);
      EXPECT_NEAR(std::abs(direction.dot(Vector2d(std::cos(angle), std::sin(angle)))), 1, 1e-9);
    }
}

TEST(FootprintCovariance, LengthensVanishingAxes) {
  EXPECT_TRUE(footprint_covariance(Matrix2d::Zero(), 1).isApprox(1e-14 * Matrix2d::Identity()));
  const PrincipalAxes axes = principal_axes(footprint_covariance(differentials(1, 0, 0.7), 1));
  EXPECT_NEAR(axes.eigenvalues[0] / 1e-14, 1, 1e-3);
  EXPECT_NEAR(axes.eigenvalues[1] / 1e-10, 1, 1e-3);
}

// The oracle takes nothing less, and the audit of a picture with a horizon asks it.
TEST(FootprintCovariance, IsSymmetricToTheLastBit) {
  for (int n = 0; n < 200; ++n) {
    const double minor = n % 2 ? 1e-3 : 0.3;  // bounded, and not
    const Matrix2d covariance = footprint_covariance(differentials(1 + 0.07 * n, minor, 0.031 * n), 0.37);
    ASSERT_EQ(covariance(0, 1), covariance(1, 0)) << n;
  }
}

TEST(TurnOver, IsTheHalfVectorsChangeByThatOfUv) {
  const Eigen::Matrix2d duv = (Eigen::Matrix2d() << 0.02, 0.005, -0.004, 0.03).finished(),
                        dh = (Eigen::Matrix2d() << 0.7, -0.3, 0.2, 0.6).finished();
  EXPECT_LT((turn_over(duv, dh, 0.125) * duv - dh).norm(), 1e-14);
}

/// Over a footprint's standard deviation half vectors turn by 0.4 of the disk's radius, or by a fourth of
/// that.
TEST(TurnOver, IsNoneWhereTheFirstOrderIsNone) {
  const Eigen::Matrix2d duv = 0.02 * Eigen::Matrix2d::Identity(), dh = 0.8 * Eigen::Matrix2d::Identity();
  EXPECT_EQ(turn_over(duv, dh, 0.5).norm(), 0);
  EXPECT_GT(turn_over(duv, dh, 0.125).norm(), 0);
  const Eigen::Matrix2d edge_on = Eigen::Vector2d(0.02, 0.0002).asDiagonal();
  EXPECT_EQ(turn_over(edge_on, dh, 0.125).norm(), 0);
}

}  // namespace
}  // namespace mica::host::footprint_test
