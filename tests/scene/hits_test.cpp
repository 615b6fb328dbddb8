#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "host/base/constants.h"
#include "host/scene/camera.h"
#include "host/scene/geometry.h"
#include "mica/error.h"

namespace mica::host::hits_test {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Vectors in the cube [-1, 1]^3, the same on every machine.
class Vectors {
 public:
  Vector3d next() { return {coordinate(), coordinate(), coordinate()}; }

 private:
  double coordinate() { return 2 * (static_cast<double>(engine_()) / 4294967295.0) - 1; }
  std::mt19937 engine_{7};
};

TEST(PinholeCamera, LooksWhereItIsTold) {
  CameraDescription description;
  description.position = {1, 2, 3};
  description.look_at = {1, 7, 3};
  description.fov_degrees = 90;
  const PinholeCamera camera(description, 40, 20);
  EXPECT_EQ(camera.ray(20, 10).origin, Vector3d(1, 2, 3));
  EXPECT_TRUE(camera.ray(20, 10).direction.isApprox(Vector3d(0, 1, 0)));
  // Vertical field of view: the edges of the image stand at 45 degrees; x to the right, rows from the top.
  EXPECT_TRUE(camera.ray(20, 0).direction.isApprox(Vector3d(0, 1, 1)));
  EXPECT_TRUE(camera.ray(20, 20).direction.isApprox(Vector3d(0, 1, -1)));
  EXPECT_TRUE(camera.ray(40, 10).direction.isApprox(Vector3d(2, 1, 0)));
  EXPECT_TRUE(camera.ray(0, 10).direction.isApprox(Vector3d(-2, 1, 0)));
  const CameraRay ray = camera.ray(3, 4);
  EXPECT_TRUE(camera.ray(4, 4).direction.isApprox(ray.direction + ray.ddx));
  EXPECT_TRUE(camera.ray(3, 5).direction.isApprox(ray.direction + ray.ddy));
}

TEST(PinholeCamera, RefusesToLookNowhere) {
  CameraDescription same, straight_up, wide;
  same.look_at = same.position;
  straight_up.look_at = straight_up.position + Vector3d(0, 0, 2);
  wide.fov_degrees = 180;
  for (const CameraDescription& description : {same, straight_up, wide})
    EXPECT_THROW(PinholeCamera(description, 4, 4), UsageError);
}

TEST(Geometry, PlaneIsHitWhereItIs) {
  const PlaneShape plane{{3, -2, 0.5}, 4};
  const Geometry geometry({{plane, ""}});
  Vectors vectors;
  int hits = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vector3d origin = plane.center + 3 * vectors.next(), target = plane.center + 3 * vectors.next();
    const Ray ray{origin, target - origin};
    const double t = (0.5 - origin.z()) / ray.direction.z();
    const Vector3d p = origin + t * ray.direction;
    const double outside = (p - plane.center).head<2>().cwiseAbs().maxCoeff() - 2;
    if (std::abs(outside) < 1e-4 || std::abs(t) < 1e-4) continue;
    const auto hit = geometry.intersect(ray);
    ASSERT_EQ(hit.has_value(), t > 0 && outside < 0) << i;
    if (!hit) continue;
    ++hits;
    EXPECT_NEAR((hit->position - p).norm(), 0, 1e-12);
    EXPECT_NEAR(hit->t, t, 1e-12);
    EXPECT_NEAR((hit->uv - Vector2d((p.x() - 1) / 4, (p.y() + 4) / 4)).norm(), 0, 1e-12);
    EXPECT_EQ(hit->normal, Vector3d(0, 0, 1));
    EXPECT_EQ(hit->dpdu, Vector3d(4, 0, 0));
    EXPECT_EQ(hit->dpdv, Vector3d(0, 4, 0));
  }
  EXPECT_GT(hits, 100);
}

TEST(Geometry, SphereIsHitWhereItIs) {
  const SphereShape sphere{{1, 2, -3}, 1.5};
  const Geometry geometry({{sphere, ""}});
  Vectors vectors;
  int from_outside = 0, from_inside = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vector3d origin = sphere.center + 4 * vectors.next(), target = sphere.center + 1.5 * vectors.next();
    const Vector3d d = (target - origin).normalized(), c = origin - sphere.center;
    const double b = c.dot(d), discriminant = b * b - (c.squaredNorm() - 2.25);
    if (std::abs(discriminant) < 1e-3 || std::abs(c.norm() - 1.5) < 1e-3) continue;
    const bool inside = c.norm() < 1.5;
    const auto hit = geometry.intersect({origin, target - origin});
    ASSERT_EQ(hit.has_value(), discriminant > 0 && (inside || b < 0)) << i;
    if (!hit) continue;
    ++(inside ? from_inside : from_outside);
    const Vector3d p = origin + (-b + (inside ? 1 : -1) * std::sqrt(discriminant)) * d;
    EXPECT_NEAR((hit->position - p).norm(), 0, 1e-12);
    EXPECT_NEAR((origin + hit->t * (target - origin) - p).norm(), 0, 1e-11);
    const Vector3d n = (p - sphere.center) / 1.5;
    EXPECT_NEAR((hit->normal - n).norm(), 0, 1e-12);
    // The point that (u, v) names, and its derivatives.
    const auto point = [&](double u, double v) {
      const double latitude = (v - 0.5) * kPi;
      return Vector3d(sphere.center + 1.5 * Vector3d(std::cos(latitude) * std::cos(2 * kPi * u),
                                                     std::cos(latitude) * std::sin(2 * kPi * u),
                                                     std::sin(latitude)));
    };
    const double u = hit->uv.x(), v = hit->uv.y(), h = 1e-5;
    EXPECT_NEAR((point(u, v) - p).norm(), 0, 1e-12);
    EXPECT_NEAR((hit->dpdu - (point(u + h, v) - point(u - h, v)) / (2 * h)).norm(), 0, 1e-7);
    EXPECT_NEAR((hit->dpdv - (point(u, v + h) - point(u, v - h)) / (2 * h)).norm(), 0, 1e-7);
    EXPECT_TRUE(u >= 0 && u < 1 && v >= 0 && v <= 1);
  }
  EXPECT_GT(from_outside, 100);
  EXPECT_GT(from_inside, 20);
}

TEST(Geometry, PolesOfTheSphereAreFinite) {
  const Geometry geometry({{SphereShape{}, ""}});
  const auto hit = geometry.intersect({{0, 0, 3}, {0, 0, -1}});
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->uv.y(), 1);
  EXPECT_TRUE(hit->dpdu.allFinite() && hit->dpdu.norm() > 0 && hit->dpdv.norm() > 3);
  EXPECT_NEAR(hit->tangent.norm(), 1, 1e-15);
}

TEST(HitTriangle, InterpolatesExactly) {
  TriangleMesh mesh;
  mesh.positions = {{0.5f, -1, 2}, {3, 0.25f, 2.5f}, {1, 4, 1}};
  mesh.normals = {{0, 0, 1}, {0.6f, 0, 0.8f}, {0, 0.6f, 0.8f}};
  mesh.uvs = {{0.1, 0.2}, {5.3, -0.7}, {1.9, 8.8}};
  mesh.triangles = {{0, 1, 2}};
  set_tangents(&mesh);
  const auto position = [&](double b, double c) {
    return Vector3d((1 - b - c) * mesh.positions[0].cast<double>() + b * mesh.positions[1].cast<double>() +
                    c * mesh.positions[2].cast<double>());
  };
  const auto uv = [&](double b, double c) {
    return Vector2d((1 - b - c) * mesh.uvs[0] + b * mesh.uvs[1] + c * mesh.uvs[2]);
  };
  const Vector3d eye(2, 1, 30);
  for (const auto& [b, c] : {std::pair{0.2, 0.3}, {0.01, 0.98}, {0.6, 0.05}}) {
    const Hit hit = hit_triangle(mesh, 0, {eye, position(b, c) - eye});
    EXPECT_NEAR(hit.t, 1, 1e-12);
    EXPECT_NEAR((hit.position - position(b, c)).norm(), 0, 1e-12);
    EXPECT_NEAR((hit.uv - uv(b, c)).norm(), 0, 1e-12);
    EXPECT_NEAR(hit.normal.norm(), 1, 1e-12);
    EXPECT_GT(hit.normal.x(), 0);
    // Along the triangle, uv changes as its derivatives say.
    const Vector3d dp = position(b + 0.1, c) - position(b, c);
    const Vector2d duv = uv(b + 0.1, c) - uv(b, c);
    EXPECT_NEAR((hit.dpdu * duv.x() + hit.dpdv * duv.y() - dp).norm(), 0, 1e-12);
    EXPECT_NEAR(hit.dpdu.dot(hit.face_normal), 0, 1e-12);
    EXPECT_NEAR(hit.tangent.normalized().dot(hit.dpdu.normalized()), 1, 1e-6);
  }
}

TEST(HitTriangle, DegenerateUvHasNoDirection) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.normals.assign(3, {0, 0, 1});
  mesh.uvs = {{0.5, 0.5}, {0.6, 0.6}, {0.7, 0.7}};
  mesh.triangles = {{0, 1, 2}};
  set_tangents(&mesh);
  const Hit hit = hit_triangle(mesh, 0, {{0.2, 0.2, 1}, {0, 0, -1}});
  EXPECT_EQ(hit.dpdu, Vector3d::Zero());
  EXPECT_EQ(hit.dpdv, Vector3d::Zero());
  EXPECT_EQ(hit.tangent, Vector3d::Zero());
  EXPECT_TRUE(hit.uv.allFinite());
}

TEST(Geometry, FindsTheFirstOfSeveralShapes) {
  const Geometry geometry(
      {{PlaneShape{}, ""}, {SphereShape{{0, 0, 2}, 0.5}, ""}, {ShellShape{{0, 0, 4}}, ""}});
  EXPECT_EQ(geometry.intersect({{0, 0, 10}, {0, 0, -1}})->shape, 2u);
  EXPECT_EQ(geometry.intersect({{0, 0, 3}, {0, 0, -1}})->shape, 1u);
  EXPECT_EQ(geometry.intersect({{0, 0, 1}, {0, 0, -1}})->shape, 0u);
  EXPECT_FALSE(geometry.intersect({{0, 0, 10}, {0, 0, 1}}));
  EXPECT_FALSE(Geometry({}).intersect({{0, 0, 0}, {0, 0, 1}}));
}

TEST(Geometry, OccludesUpToTheLight) {
  const Geometry geometry({{PlaneShape{}, ""}, {SphereShape{{0, 0, 2}, 0.5}, ""}});
  const auto below = geometry.intersect({{0.1, 0, 1}, {0, 0, -1}});
  EXPECT_TRUE(geometry.occluded(*below, {0, 0, 1}, INFINITY));
  EXPECT_TRUE(geometry.occluded(*below, {0, 0, 1}, 2));
  EXPECT_FALSE(geometry.occluded(*below, {0, 0, 1}, 1.4)) << "a light before the sphere";
  EXPECT_FALSE(geometry.occluded(*below, {1, 0, 0.01}, INFINITY));
  EXPECT_FALSE(geometry.occluded(*below, {0, 0, -1}, INFINITY)) << "the other side of the plane";
}

ShapeDescription placed_plane(double size, const Eigen::Vector3d& at,
                              const Eigen::Vector3d& turn = {0, 0, 0}) {
  return {PlaneShape{{0, 0, 0}, size}, "", {{1, 1, 1}, turn, at}};
}

TEST(Geometry, WhatIsNearIsInTheWayHoweverFarAndLargeTheSceneIs) {
  for (const double height : {0.1, 0.01, 0.001})
    for (const auto& [far, floor] :
         std::vector<std::pair<double, double>>{{0, 4}, {1e3, 4}, {1e4, 4}, {1e5, 4}, {0, 1e3}, {0, 1e5}}) {
      const Eigen::Vector3d at = Eigen::Vector3d::Constant(far), up(0, 0, height);
      const Geometry geometry({placed_plane(floor, at), placed_plane(2, at + up)});
      for (double x = -0.9; x < 1; x += 0.173) {
        const Ray ray{at + Eigen::Vector3d(x, 0, height / 2), Eigen::Vector3d(0.1, 0.2, -1)};
        const auto hit = geometry.intersect(ray);
        ASSERT_TRUE(hit && hit->shape == 0) << height << " " << far << " " << floor;
        EXPECT_TRUE(geometry.occluded(*hit, Eigen::Vector3d(0.1, 0, 1).normalized(), 2))
            << height << " " << far << " " << floor;
      }
    }
}

TEST(Geometry, NothingIsInItsOwnWay) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int n = 0; n < 2000; ++n) {
    const auto draw = [&](double scale) {
      return Eigen::Vector3d(scale * Eigen::Vector3d(uniform(random), uniform(random), uniform(random)));
    };
    const double size = std::exp2(10 * uniform(random));
    const Eigen::Vector3d at = draw(std::exp2(10 * uniform(random)));
    ShapeDescription shape = placed_plane(size, at, draw(180));
    if (n % 4 == 0) shape.placement = {};  // exactly in z = 0, where nothing is rounded
    if (n % 2) shape.geometry = SphereShape{{0, 0, 0}, size / 2};
    const Geometry geometry({shape});
    const auto hit = geometry.intersect({shape.placement.translate + draw(3 * size), draw(1)});
    if (!hit) continue;
    const Eigen::Vector3d leaving = hit->face_normal + 0.9 * draw(1).normalized();
    EXPECT_FALSE(geometry.occluded(*hit, leaving.normalized(), INFINITY)) << n;
  }
}

TEST(Geometry, RefusesShapesWithoutExtent) {
  EXPECT_THROW(Geometry({{PlaneShape{{0, 0, 0}, 0}, ""}}), UsageError);
  EXPECT_THROW(Geometry({{SphereShape{{0, 0, 0}, -1}, ""}}), UsageError);
  EXPECT_THROW(Geometry({{SphereShape{{0, NAN, 0}, 1}, ""}}), UsageError);
  EXPECT_THROW(Geometry({{ShellShape{{0, 0, 0}, 0, 4}, ""}}), UsageError);
  EXPECT_THROW(Geometry({{ShellShape{{0, 0, 0}, 1, 1e9}, ""}}), UsageError);
}

}  // namespace
}  // namespace mica::host::hits_test
