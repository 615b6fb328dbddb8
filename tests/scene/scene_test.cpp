#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstring>
#include <functional>

#include "host/base/constants.h"
#include "host/base/symmetric_matrix.h"
#include "host/microfacet/masking.h"
#include "host/scene/camera.h"
#include "host/scene/fresnel.h"
#include "host/scene/scene.h"
#include "mica/error.h"
#include "tests/scene/pixel_radiance.h"

namespace mica::host::scene_test {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;

SceneDescription with_shapes(const std::vector<decltype(ShapeDescription::geometry)>& shapes) {
  SceneDescription description;
  MaterialDescription material;
  material.name = "m";
  material.repeat = {3, 5};
  material.roughness = 0.02;
  material.specular = DielectricFresnel{1.5};
  material.diffuse = {0.5, 0.25, 0.125};
  description.materials = {MaterialDescription{}, material};
  for (const auto& shape : shapes) description.shapes.push_back({shape, "m"});
  description.camera.position = {0.2, -3.2, 1.4};
  description.camera.look_at = {0, 0, 0.3};
  return description;
}

template <class Vector>
bool same_bits(const Vector& a, const Vector& b) {
  return std::memcmp(a.data(), b.data(),
                     sizeof(typename Vector::Scalar) * static_cast<std::size_t>(a.size())) == 0;
}

template <class Element>
bool same_bits(const std::vector<Element>& a, const std::vector<Element>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const Element& x, const Element& y) { return same_bits(x, y); });
}

bool same_bits(const std::vector<GlintQuery>& a, const std::vector<GlintQuery>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const GlintQuery& x, const GlintQuery& y) {
    return same_bits(x.query.footprint.mean_uv, y.query.footprint.mean_uv) &&
           same_bits(x.query.footprint.cov_uv, y.query.footprint.cov_uv) &&
           same_bits(x.query.half_vector, y.query.half_vector) && same_bits(x.weight, y.weight) &&
           x.query.roughness == y.query.roughness && x.pixel == y.pixel && x.material == y.material;
  });
}

bool same_bits(const TracedRows& a, const TracedRows& b) {
  return a.first_row == b.first_row && a.row_count == b.row_count && same_bits(a.queries, b.queries) &&
         same_bits(pixel_radiance(a), pixel_radiance(b)) && same_bits(a.uv, b.uv) &&
         same_bits(a.footprint, b.footprint) && same_bits(a.normal, b.normal) &&
         a.query_count == b.query_count;
}

/// Appends the rows of `next`, which follow those of `rows`.
void append(TracedRows next, TracedRows* rows) {
  const auto pixels_before = static_cast<std::uint32_t>(rows->radiance.size());
  for (GlintQuery& query : next.queries) query.pixel += pixels_before;
  const auto add = [](const auto& from, auto* to) { to->insert(to->end(), from.begin(), from.end()); };
  rows->row_count += next.row_count;
  add(next.queries, &rows->queries);
  // From here on all pixels have their light, and none of it in samples.
  add(pixel_radiance(next), &rows->radiance);
  rows->fitted.resize(rows->radiance.size(), 1);
  add(next.uv, &rows->uv);
  add(next.footprint, &rows->footprint);
  add(next.normal, &rows->normal);
  add(next.query_count, &rows->query_count);
}

TEST(Scene, RowsAreTheSameHoweverTheyAreSplitAndThreaded) {
  SceneDescription description = with_shapes({ShellShape{}, PlaneShape{}, SphereShape{{-1.2, 0, 0.3}, 0.3}});
  description.lights = {PointLight{}, DirectionalLight{{1, 1, -1}}};
  const int width = 64, height = 36;
  const Scene scene(description, width, height, 3);
  const TracedRows whole = scene.trace(0, height);
  ASSERT_GT(whole.queries.size(), 10000u);

  for (const int step : {1, 7}) {
    TracedRows joined = scene.trace(0, 0);
    for (int row = 0; row < height; row += step)
      append(scene.trace(row, std::min(step, height - row)), &joined);
    EXPECT_TRUE(same_bits(joined, whole)) << step;
  }
  for (const std::size_t threads : {1, 5}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    EXPECT_TRUE(same_bits(scene.trace(0, height), whole)) << threads;
    EXPECT_TRUE(same_bits(Scene(description, width, height, 3).trace(0, height), whole)) << threads;
  }
}

TEST(Scene, LambertianPlaneReflectsItsAlbedo) {
  SceneDescription description = with_shapes({PlaneShape{{0, 0, 0}, 100}});
  description.lights = {DirectionalLight{{1, 0, -1}, {3, 2, 1}}};
  description.materials[1].specular = DielectricFresnel{1};  // takes nothing
  description.camera.position = {0, -1, 2};
  description.camera.look_at = {0, 0, 0};
  const TracedRows rows = Scene(description, 16, 9, 2).trace(0, 9);
  const Vector3d expected = Vector3d(0.5 * 3, 0.25 * 2, 0.125 * 1) / kPi * std::cos(kPi / 4);
  for (const Vector3f& radiance : pixel_radiance(rows))
    EXPECT_TRUE(radiance.cast<double>().isApprox(expected, 1e-6));
  for (const Vector3f& normal : rows.normal) EXPECT_TRUE(normal.isApprox(Vector3f::UnitZ()));
}

/// Calls `check` with each query of a scene of one subpixel a pixel, and with the ray that led to it.
void for_each_query(const SceneDescription& description, const std::vector<SmoothLobe>& lobes,
                    const std::function<void(const GlintQuery&, const CameraRay&)>& check) {
  const int width = 32, height = 18;
  const PinholeCamera camera(description.camera, width, height);
  const TracedRows rows = Scene(description, width, height, 1, lobes).trace(0, height);
  ASSERT_GT(rows.queries.size(), 50u);
  for (const GlintQuery& query : rows.queries)
    check(query, camera.ray(query.pixel % width + 0.5, query.pixel / width + 0.5));
}

TEST(Scene, QueriesOfAPlaneAreThoseOfTheClosedForm) {
  SceneDescription description = with_shapes({PlaneShape{{0.5, 0.25, 0}, 8}});
  const PointLight light{{1, 2, 3}, {40, 50, 60}};
  description.lights = {light};
  for_each_query(description, {0.7, 0.3}, [&](const GlintQuery& query, const CameraRay& ray) {
    const Vector3d p = ray.origin - ray.origin.z() / ray.direction.z() * ray.direction;
    const Vector3d o = -ray.direction.normalized(), i = (light.position - p).normalized(),
                   h = (o + i).normalized();
    const Vector2d map_uv(3 * ((p.x() - 0.5) / 8 + 0.5), 5 * ((p.y() - 0.25) / 8 + 0.5));
    const Vector2d wrapped(map_uv.x() - std::floor(map_uv.x()), map_uv.y() - std::floor(map_uv.y()));
    EXPECT_NEAR((query.query.footprint.mean_uv - wrapped).norm(), 0, 1e-12);
    EXPECT_NEAR((query.query.half_vector - h.head<2>()).norm(), 0, 1e-12);
    EXPECT_EQ(query.query.roughness, 0.02);
    EXPECT_EQ(query.material, 1u);
    const double G = smith_masking_shadowing(o.z(), i.z(), 0.3);
    const double f_over_D = dielectric_reflectance(i.dot(h), 1.5) * G / (4 * i.z() * o.z());
    const Vector3d expected = f_over_D * i.z() / (light.position - p).squaredNorm() * light.intensity;
    EXPECT_TRUE(query.weight.cast<double>().isApprox(expected, 1e-6));
  });
}

TEST(Scene, QueriesOfASphereUseItsTangentFrame) {
  SceneDescription description = with_shapes({SphereShape{{0, 0, 0.4}, 0.8}});
  description.lights = {DirectionalLight{{0.3, 1, -0.5}}};
  const Vector3d i = -Vector3d(0.3, 1, -0.5).normalized();
  for_each_query(description, {}, [&](const GlintQuery& query, const CameraRay& ray) {
    const Vector3d c = ray.origin - Vector3d(0, 0, 0.4), d = ray.direction.normalized();
    const double b = c.dot(d), t = -b - std::sqrt(std::max(0.0, b * b - c.squaredNorm() + 0.64));
    const Vector3d n = (c + t * d).normalized(), east = Vector3d::UnitZ().cross(n).normalized(),
                   north = n.cross(east);
    const Vector3d h = (i - d).normalized();
    EXPECT_NEAR((query.query.half_vector - Vector2d(h.dot(east), h.dot(north))).norm(), 0, 1e-9);
    EXPECT_GT(i.dot(n), 0);
  });
}

TEST(Scene, FootprintsAreHalfASubpixel) {
  SceneDescription description = with_shapes({PlaneShape{{0, 0, 0}, 4}});
  description.camera.position = {0, 0, 5};
  description.camera.up = {0, 1, 0};
  description.camera.look_at = {0, 0, 0};
  description.lights = {PointLight{}};
  for (const int subpixels : {1, 4}) {
    const TracedRows rows = Scene(description, 20, 10, subpixels).trace(0, 10);
    const double pixel = 2 * 5 * std::tan(description.camera.fov_degrees * kPi / 360) / 10;
    const double sigma = 0.5 * pixel / subpixels / 4;  // the plane's side is 4
    for (const GlintQuery& query : rows.queries) {
      const Eigen::Matrix2d& covariance = query.query.footprint.cov_uv;
      EXPECT_NEAR(std::sqrt(covariance(0, 0)), 3 * sigma, 1e-12);
      EXPECT_NEAR(std::sqrt(covariance(1, 1)), 5 * sigma, 1e-12);
      EXPECT_NEAR(covariance(0, 1), 0, 1e-15);
      EXPECT_EQ(covariance(0, 1), covariance(1, 0));
    }
    const std::size_t middle = 5 * 20 + 10;
    EXPECT_NEAR(std::sqrt(rows.footprint[middle].x()), 3 * sigma, 1e-7);
    EXPECT_NEAR(std::sqrt(rows.footprint[middle].z()), 5 * sigma, 1e-7);
  }
}

TEST(Scene, SubpixelsShareTheWeightOfAPixel) {
  SceneDescription description = with_shapes({PlaneShape{{0, 0, 0}, 100}});
  description.lights = {PointLight{{0, 0, 4}, {10, 10, 10}}};
  description.camera.position = {0, -1, 3};
  description.camera.look_at = {0, 0, 0};
  const auto pixel_weight = [&](int subpixels) {
    Vector3f sum = Vector3f::Zero();
    for (const GlintQuery& query : Scene(description, 16, 9, subpixels).trace(4, 1).queries)
      sum += query.weight / static_cast<float>(subpixels * subpixels);
    return sum;
  };
  EXPECT_TRUE(pixel_weight(1).isApprox(pixel_weight(4), 1e-3f));
}

TEST(Scene, ShadowIsWhereTheSphereStandsBeforeTheLight) {
  const SphereShape sphere{{0, 0, 1}, 0.4};
  SceneDescription description = with_shapes({PlaneShape{}, sphere});
  const PointLight light{{0.5, -0.5, 3}, {10, 10, 10}};
  description.lights = {light};
  const int width = 160, height = 90;
  const PinholeCamera camera(description.camera, width, height);
  const TracedRows rows = Scene(description, width, height, 1).trace(0, height);
  const std::vector<Vector3f> radiance = pixel_radiance(rows);
  int lit = 0, shadowed = 0;
  for (int pixel = 0; pixel < width * height; ++pixel) {
    const CameraRay ray = camera.ray(pixel % width + 0.5, pixel / width + 0.5);
    const auto misses_by = [&](const Vector3d& from, const Vector3d& to) {
      const Vector3d d = (to - from).normalized();
      return ((sphere.center - from) - (sphere.center - from).dot(d) * d).norm() - sphere.radius;
    };
    const Vector3d p = ray.origin - ray.origin.z() / ray.direction.z() * ray.direction;
    if (ray.direction.z() > -0.05 || p.head<2>().cwiseAbs().maxCoeff() > 4.99) continue;
    if (misses_by(ray.origin, p) < 1e-3) continue;  // sees the sphere
    const double margin = misses_by(p, light.position);
    if (std::abs(margin) < 1e-4) continue;
    const std::size_t index = static_cast<std::size_t>(pixel);
    EXPECT_EQ(rows.query_count[index], margin > 0 ? 1 : 0) << pixel;
    EXPECT_EQ(radiance[index].x() > 0, margin > 0) << pixel;
    ++(margin > 0 ? lit : shadowed);
  }
  EXPECT_GT(lit, 1000);
  EXPECT_GT(shadowed, 100);
}

TEST(Scene, NothingShadowsItself) {
  // A light that grazes each surface: all of it that faces the light must see it.
  const auto lit_share = [](SceneDescription description, const Vector3d& direction) {
    description.lights = {DirectionalLight{direction}};
    const TracedRows rows = Scene(description, 120, 68, 1).trace(0, 68);
    int facing = 0, lit = 0;
    for (std::size_t pixel = 0; pixel < rows.normal.size(); ++pixel)
      if (rows.normal[pixel].cast<double>().dot(-direction.normalized()) > 1e-4) {
        ++facing;
        lit += rows.query_count[pixel];
      }
    EXPECT_GT(facing, 200);
    return static_cast<double>(lit) / facing;
  };
  for (const double size : {1.0, 10.0, 1e4}) {
    EXPECT_EQ(lit_share(with_shapes({PlaneShape{{0, 0, 0}, size}}), {1, 0.3, -0.01}), 1) << size;
    EXPECT_EQ(lit_share(with_shapes({PlaneShape{{0, 0, 0}, size}}), {0, 0, -1}), 1) << size;
  }
  EXPECT_EQ(lit_share(with_shapes({SphereShape{{0, 0, 0.4}, 0.8}}), {1, 0.3, -0.01}), 1);
  SceneDescription far = with_shapes({SphereShape{{5000, 0, 0}, 800}});
  far.camera.position = {0, 0, 0};
  far.camera.look_at = {1, 0, 0};
  EXPECT_EQ(lit_share(far, {1, 0.3, -0.01}), 1);
}

TEST(Scene, SurfacesAreDarkUnlessEyeAndLightAreOnTheSameSide) {
  SceneDescription description = with_shapes({PlaneShape{}});
  description.lights = {DirectionalLight{{0, 0, 1}}};
  EXPECT_TRUE(Scene(description, 8, 8, 1).trace(0, 8).queries.empty());
  description.lights = {PointLight{{0, 0, -1}}};
  EXPECT_TRUE(Scene(description, 8, 8, 1).trace(0, 8).queries.empty());
}

TEST(Scene, SurfacesFromBehindShowTheSameMap) {
  SceneDescription description = with_shapes({PlaneShape{}});
  description.lights = {DirectionalLight{{0.2, -0.4, 1}}};
  description.camera.position = {0.2, -3.2, -1.4};
  description.camera.look_at = {0, 0, 0};
  const Vector3d i = -Vector3d(0.2, -0.4, 1).normalized();
  for_each_query(description, {}, [&](const GlintQuery& query, const CameraRay& ray) {
    const Vector3d h = (i - ray.direction.normalized()).normalized();
    EXPECT_LT(h.z(), 0);
    EXPECT_NEAR((query.query.half_vector - h.head<2>()).norm(), 0, 1e-12);
  });
}

TEST(Scene, EveryNumberIsInRange) {
  SceneDescription description =
      with_shapes({ShellShape{}, PlaneShape{{0, 0, 0}, 1000}, SphereShape{{-1.2, 0, 0.3}, 0.3}});
  description.lights = {PointLight{{2, -2, 4}, {60, 60, 60}}};
  const TracedRows rows = Scene(description, 128, 72, 2).trace(0, 72);
  const std::vector<Vector3f> radiance = pixel_radiance(rows);
  for (const GlintQuery& query : rows.queries) {
    const Footprint& footprint = query.query.footprint;
    ASSERT_TRUE(footprint.mean_uv.minCoeff() >= 0 && footprint.mean_uv.maxCoeff() < 1);
    ASSERT_LT(query.query.half_vector.norm(), 1);
    ASSERT_TRUE(query.weight.allFinite() && query.weight.minCoeff() >= 0);
    const PrincipalAxes axes = principal_axes(footprint.cov_uv);
    ASSERT_GT(axes.eigenvalues[0], 0);
    ASSERT_LT(axes.eigenvalues[1] / axes.eigenvalues[0], 1.001e4);
  }
  for (std::size_t pixel = 0; pixel < rows.uv.size(); ++pixel) {
    ASSERT_TRUE(rows.uv[pixel].minCoeff() >= 0 && rows.uv[pixel].maxCoeff() < 1);
    ASSERT_TRUE(rows.footprint[pixel].allFinite() && radiance[pixel].allFinite());
  }
}

TEST(Scene, MeanUvStaysAtTheWrap) {
  SceneDescription description = with_shapes({PlaneShape{{0, 0, 0}, 4}});
  description.materials[1].repeat = {2,
                                     2};  // the map's corner lies at the origin, in the middle of the pixel
  description.camera.position = {0, 0, 5};
  description.camera.up = {0, 1, 0};
  description.camera.look_at = {0, 0, 0};
  const TracedRows rows = Scene(description, 9, 9, 4).trace(4, 1);
  const Vector2d uv = rows.uv[4].cast<double>();
  for (int axis = 0; axis < 2; ++axis) EXPECT_LT(std::min(uv[axis], 1 - uv[axis]), 1e-6);
}

TEST(Scene, BackgroundShowsWhereNothingIsHit) {
  SceneDescription description = with_shapes({PlaneShape{{0, 0, 0}, 2}});
  description.background.color = {4, 2, 1};
  description.camera.position = {0, 0, 5};
  description.camera.up = {0, 1, 0};
  description.camera.look_at = {0, 0, 0};
  description.camera.fov_degrees = 2 * std::atan(1.0 / 5) * 180 / kPi;  // the plane is as high as the image
  const TracedRows rows = Scene(description, 5, 2, 4).trace(0, 2);      // pixel 1 and 3 are half covered
  const std::vector<Vector3f> radiance = pixel_radiance(rows);
  const float expected[] = {4, 2, 0, 2, 4};
  for (std::size_t pixel = 0; pixel < 10; ++pixel) {
    EXPECT_NEAR(radiance[pixel].x(), expected[pixel % 5], 1e-6);
    EXPECT_EQ(rows.normal[pixel].isZero(), pixel % 5 == 0 || pixel % 5 == 4);
    EXPECT_EQ(rows.query_count[pixel], 0);
  }
}

TEST(Scene, RefusesWhatMakesNoSense) {
  const SceneDescription good = with_shapes({PlaneShape{}});
  for (const int subpixels : {0, 17, -1}) EXPECT_THROW(Scene(good, 8, 8, subpixels), UsageError);
  EXPECT_THROW(Scene(good, 0, 8, 1), UsageError);
  EXPECT_THROW(Scene(good, 8, 8, 1, {0.1, NAN}), UsageError);

  SceneDescription unnamed = good, dark = good, aimless = good;
  unnamed.shapes[0].material = "unheard-of";
  EXPECT_THROW(Scene(unnamed, 8, 8, 1), UsageError);
  dark.lights = {PointLight{{0, 0, 1}, {1, -1, 1}}};
  EXPECT_THROW(Scene(dark, 8, 8, 1), UsageError);
  aimless.lights = {DirectionalLight{{0, 0, 0}}};
  EXPECT_THROW(Scene(aimless, 8, 8, 1), UsageError);

  const Scene scene(good, 8, 8, 1);
  EXPECT_THROW(scene.trace(-1, 2), UsageError);
  EXPECT_THROW(scene.trace(7, 2), UsageError);
  EXPECT_THROW(scene.trace(0, -1), UsageError);
  EXPECT_EQ(scene.trace(8, 0).row_count, 0);
}

}  // namespace
}  // namespace mica::host::scene_test
