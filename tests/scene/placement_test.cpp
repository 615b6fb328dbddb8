// Shapes that stand somewhere else: against the same shapes described where they stand.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "host/scene/geometry.h"
#include "mica/error.h"

namespace mica::host::placement_test {
namespace {

using Eigen::Vector3d;

class Directions {
 public:
  Vector3d next() { return Vector3d(number(), number(), number()); }

 private:
  double number() { return 2 * (static_cast<double>(engine_()) / 4294967295.0) - 1; }
  std::mt19937 engine_{11};
};

void expect_same(const Hit& a, const Hit& b) {
  EXPECT_NEAR(a.t, b.t, 1e-5);
  EXPECT_NEAR((a.position - b.position).norm(), 0, 1e-5);
  EXPECT_NEAR((a.normal - b.normal).norm(), 0, 1e-5);
  EXPECT_NEAR((a.face_normal - b.face_normal).norm(), 0, 1e-5);
  EXPECT_NEAR((a.dpdu - b.dpdu).norm(), 0, 1e-4 * b.dpdu.norm());
  EXPECT_NEAR((a.dpdv - b.dpdv).norm(), 0, 1e-4 * b.dpdv.norm());
  EXPECT_NEAR((a.uv - b.uv).norm(), 0, 1e-5);
}

TEST(Placement, MovedAndScaledSphereIsTheSphereThatIsThere) {
  ShapeDescription placed{SphereShape{{0, 0, 0}, 1}, ""};
  placed.placement.scale = {0.5, 0.5, 0.5};
  placed.placement.translate = {1, 2, 3};
  const Geometry moved({placed}), there({{SphereShape{{1, 2, 3}, 0.5}, ""}});
  Directions directions;
  int hits = 0;
  for (int n = 0; n < 500; ++n) {
    const Vector3d origin = Vector3d(1, 2, 3) + 3 * directions.next();
    const Ray ray{origin, Vector3d(1, 2, 3) + 0.4 * directions.next() - origin};
    const auto a = moved.intersect(ray), b = there.intersect(ray);
    if (!a || !b || (origin - Vector3d(1, 2, 3)).norm() < 0.6) continue;
    expect_same(*a, *b);
    ++hits;
  }
  EXPECT_GT(hits, 300);
}

// Counterclockwise about x, then y, then z: a plane that faces up faces -y after a quarter turn about x, then
// +x after one about z.
TEST(Placement, TurnsAboutXThenYThenZ) {
  ShapeDescription plane{PlaneShape{{0, 0, 0}, 2}, ""};
  plane.placement.rotate_degrees = {90, 0, 90};
  plane.placement.translate = {5, 0, 0};
  const Geometry geometry({plane});
  const auto hit = geometry.intersect({{8, 0.25, 0.5}, {-1, 0, 0}});
  ASSERT_TRUE(hit);
  EXPECT_NEAR((hit->position - Vector3d(5, 0.25, 0.5)).norm(), 0, 1e-12);
  EXPECT_NEAR((hit->normal - Vector3d(1, 0, 0)).norm(), 0, 1e-12);
  EXPECT_NEAR((hit->dpdu - Vector3d(0, 2, 0)).norm(), 0, 1e-12);
  EXPECT_NEAR((hit->dpdv - Vector3d(0, 0, 2)).norm(), 0, 1e-12);
  EXPECT_NEAR((hit->uv - Eigen::Vector2d(0.625, 0.75)).norm(), 0, 1e-12);
}

// An ellipsoid's normal is the gradient of x^2 / a^2 + y^2 / b^2 + z^2 / c^2, not the stretched sphere's.
TEST(Placement, NormalsOfStretchedShapesStandUpright) {
  ShapeDescription sphere{SphereShape{{0, 0, 0}, 1}, ""};
  sphere.placement.scale = {3, 1, 0.5};
  const Geometry geometry({sphere});
  Directions directions;
  for (int n = 0; n < 200; ++n) {
    const Vector3d origin = 8 * directions.next();
    if (origin.norm() < 5) continue;
    const auto hit = geometry.intersect({origin, -origin + 0.2 * directions.next()});
    ASSERT_TRUE(hit);
    const Vector3d p = hit->position;
    EXPECT_NEAR(p.x() * p.x() / 9 + p.y() * p.y() + p.z() * p.z() * 4, 1, 1e-9);
    const Vector3d gradient = Vector3d(p.x() / 9, p.y(), p.z() * 4).normalized();
    EXPECT_NEAR((hit->normal - gradient).norm(), 0, 1e-9);
    EXPECT_NEAR(hit->dpdu.dot(gradient) / hit->dpdu.norm(), 0, 1e-9);
    EXPECT_NEAR(hit->dpdv.dot(gradient) / hit->dpdv.norm(), 0, 1e-9);
  }
}

TEST(Placement, EqualShapesAreFoundApart) {
  ShapeDescription near{ShellShape{{0, 0, 0}, 1, 2}, ""}, far = near, described = near;
  far.placement.translate = {0, 5, 0};
  far.placement.rotate_degrees = {0, 0, 180};
  const Geometry geometry({near, far, described});
  const auto first = geometry.intersect({{0, -4, 0.4}, {0, 1, 0}}),
             second = geometry.intersect({{0, 9, 0.4}, {0, -1, 0}});
  ASSERT_TRUE(first && second);
  EXPECT_TRUE(first->shape == 0 || first->shape == 2);
  EXPECT_EQ(second->shape, 1u);
  EXPECT_NEAR((first->uv - second->uv).norm(), 0, 1e-4);  // seen from the same side
  EXPECT_NEAR(first->position.y(), 5 - second->position.y(), 1e-5);
}

TEST(Placement, ShadowsFallFromWhereShapesStand) {
  ShapeDescription plane{PlaneShape{{0, 0, 0}, 40}, ""}, ball{SphereShape{{0, 0, 0}, 1}, ""};
  ball.placement.translate = {3, 0, 2};
  const Geometry geometry({plane, ball});
  for (const double x : {0.0, 1.5, 2.5, 3.0, 3.5, 4.5}) {
    const auto hit = geometry.intersect({{x, 0, 0.5}, {0, 0, -1}});
    ASSERT_TRUE(hit);
    EXPECT_EQ(geometry.occluded(*hit, {0, 0, 1}, 100), std::abs(x - 3) < 1) << x;
  }
}

TEST(Placement, RefusesWhatMakesNoSense) {
  for (const Vector3d& scale : {Vector3d(0, 1, 1), Vector3d(1, -1, 1), Vector3d(1, 1, NAN)}) {
    ShapeDescription shape{SphereShape{}, ""};
    shape.placement.scale = scale;
    EXPECT_THROW(Geometry({shape}), UsageError);
  }
}

}  // namespace
}  // namespace mica::host::placement_test
