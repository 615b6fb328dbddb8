// Lights with an extent: what they send, how they spread the half vector, and the shadows that they cast.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "host/base/constants.h"
#include "host/base/error_norms.h"
#include "host/scene/camera.h"
#include "host/scene/light_samples.h"
#include "host/scene/scene.h"
#include "host/scene/shading.h"
#include "tests/scene/pixel_radiance.h"

namespace mica::host::lights_test {
namespace {

using Eigen::Vector3d;

/// Irradiance on a patch at `place` that faces `normal`: the sum over small parts of the light's area that
/// face the patch. @param parts of the area, as (point, normal, area).
struct Part {
  Vector3d point, normal;
  double area;
};
double irradiance(const std::vector<Part>& parts, double radiance, const Vector3d& place,
                  const Vector3d& normal) {
  double sum = 0;
  for (const Part& part : parts) {
    const Vector3d way = part.point - place;
    const double out = -way.dot(part.normal), in = way.dot(normal);
    if (out > 0 && in > 0) sum += radiance * part.area * out * in / (way.squaredNorm() * way.squaredNorm());
  }
  return sum;
}

std::vector<Part> parts_of(const DiskLight& disk) {
  constexpr int rings = 400, sectors = 400;
  const Vector3d z = disk.direction.normalized(), x = z.unitOrthogonal(), y = z.cross(x);
  std::vector<Part> parts;
  for (int n = 0; n < rings; ++n)
    for (int k = 0; k < sectors; ++k) {
      const double r = disk.radius * std::sqrt((n + 0.5) / rings), turn = 2 * kPi * (k + 0.5) / sectors;
      parts.push_back({disk.position + r * (std::cos(turn) * x + std::sin(turn) * y), z,
                       kPi * disk.radius * disk.radius / (rings * sectors)});
    }
  return parts;
}

std::vector<Part> parts_of(const SphereLight& sphere) {
  constexpr int rings = 800, sectors = 800;
  std::vector<Part> parts;
  for (int n = 0; n < rings; ++n)
    for (int k = 0; k < sectors; ++k) {
      const double z = 2 * (n + 0.5) / rings - 1, r = std::sqrt(1 - z * z),
                   turn = 2 * kPi * (k + 0.5) / sectors;
      const Vector3d normal(r * std::cos(turn), r * std::sin(turn), z);
      parts.push_back({sphere.position + sphere.radius * normal, normal,
                       4 * kPi * sphere.radius * sphere.radius / (rings * sectors)});
    }
  return parts;
}

double seen_irradiance(const LightDescription& light, const Vector3d& place, const Vector3d& normal) {
  const Illumination seen = illuminate(light, place);
  return seen.irradiance[0] * seen.direction.dot(normal);
}

// pi L r^2 / (r^2 + d^2) on a disk's axis, I / d^2 from a sphere, with L = I / (pi r^2).
TEST(AreaLights, IrradianceHasItsClosedFormOnTheAxis) {
  for (const double radius : {0.1, 1.0, 5.0, 40.0}) {
    const DiskLight disk{{0, 0, 5}, {0, 0, -2}, radius, {7, 7, 7}};
    EXPECT_NEAR(seen_irradiance(disk, {0, 0, 0}, {0, 0, 1}), 7 / (25 + radius * radius), 1e-12);
  }
  EXPECT_NEAR(seen_irradiance(SphereLight{{0, 0, 5}, 3, {7, 7, 7}}, {0, 0, 0}, {0, 0, 1}), 7.0 / 25, 1e-12);
  EXPECT_EQ(illuminate(DiskLight{{0, 0, 5}, {0, 0, -1}, 0.3, {7, 7, 7}}, {0, 0, 7}).irradiance[0], 0)
      << "behind";
}

// Wherever a patch is and however it is turned, as long as all of the light is above its horizon.
TEST(AreaLights, IrradianceIsTheSumOverTheirArea) {
  const DiskLight disk{{0.5, 0.2, 2}, {0.3, -0.1, -1}, 0.8, {7, 7, 7}};
  const SphereLight sphere{{0.5, 0.2, 2}, 0.8, {7, 7, 7}};
  const double radiance = 7 / (kPi * 0.8 * 0.8);
  const std::vector<Part> of_disk = parts_of(disk), of_sphere = parts_of(sphere);
  for (const Vector3d& place : {Vector3d(0, 0, 0), Vector3d(1.5, -0.4, 0.2), Vector3d(0.6, 0.1, 0.8)})
    for (const Vector3d& turned : {Vector3d(0, 0, 1), Vector3d(0.3, 0, 1), Vector3d(-0.2, 0.3, 1)}) {
      const Vector3d normal = turned.normalized();
      const double from_disk = irradiance(of_disk, radiance, place, normal);
      EXPECT_NEAR(seen_irradiance(disk, place, normal) / from_disk, 1, 1e-4) << place.transpose();
      const double from_sphere = irradiance(of_sphere, radiance, place, normal);
      EXPECT_NEAR(seen_irradiance(sphere, place, normal) / from_sphere, 1, 3e-4) << place.transpose();
    }
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
    const ShadowRays to_light(light, {0, 0, 0});
    Eigen::Vector2d sum(0, 0);
    double squares = 0;
    for (int a = 0; a < steps; ++a)
      for (int b = 0; b < steps; ++b) {
        const ShadowRay ray = to_light.to(on_unit_disk({(a + 0.5) / steps, (b + 0.5) / steps}));
        const Vector3d half = (to_eye + ray.direction).normalized();
        const Eigen::Vector2d on_disk(half.dot(x), half.dot(y));
        sum += on_disk;
        squares += on_disk.squaredNorm();
      }
    const double count = steps * steps, variance = (squares / count - (sum / count).squaredNorm()) / 2;
    EXPECT_NEAR(half_vector_variance(seen.variance, seen.direction.dot(middle)), variance, 0.02 * variance);
  }
}

/// Queries of one pixel on the plane z = 0, seen from `eye`.
std::vector<GlintQuery> queries_under(const std::vector<LightDescription>& lights, const Vector3d& eye,
                                      double roughness, const std::optional<CoatDescription>& coat,
                                      const LampParts& parts) {
  SceneDescription scene;
  MaterialDescription material;
  material.name = "m";
  material.roughness = roughness;
  material.coat = coat;
  scene.materials = {material};
  scene.shapes = {{PlaneShape{{0, 0, 0}, 4}, "m"}};
  scene.camera.position = eye;
  scene.camera.look_at = {0, 0, 0};
  scene.camera.fov_degrees = 1;
  scene.lights = lights;
  PixelSettings pixels;
  pixels.subpixels = 1;
  pixels.filter = PixelFilter({FilterKind::gaussian});
  pixels.fits = true;
  pixels.takes_first_order = {true};
  pixels.lamp_parts = parts;
  std::vector<GlintQuery> queries = Scene(scene, 9, 9, pixels).trace(4, 1).queries;
  queries.erase(std::remove_if(queries.begin(), queries.end(),
                               [](const GlintQuery& query) { return query.pixel != 4; }),
                queries.end());
  return queries;
}

/// The lobe of its one query, for a material of tiny roughness.
Eigen::Matrix2d lobe_under(const LightDescription& light, const Vector3d& eye,
                           const std::optional<CoatDescription>& coat) {
  const std::vector<GlintQuery> queries = queries_under({light}, eye, 1e-4, coat, {});
  return queries.at(0).query.lobe_cov.value();
}

/// A direction above z = 0, below an interface on it.
Vector3d refracted(const Vector3d& direction, double ior) {
  const Eigen::Vector2d parallel = direction.head<2>() / ior;
  return {parallel.x(), parallel.y(), std::sqrt(1 - parallel.squaredNorm())};
}

// Brute force, on the disk of the surface: both variances of it, from above to 75 degrees, and below coats.
TEST(AreaLights, LobesAreAsLongAsTheirHalfVectorsSpread) {
  for (const double degrees : {40.0, 60.0, 75.0})
    for (const bool is_sphere : {true, false})
      for (const double ior : {1.0, 1.5}) {
        const double angle = degrees * kPi / 180;
        const Vector3d to_light(std::sin(angle), 0, std::cos(angle)),
            eye(-std::sin(angle), 0.2, std::cos(angle));
        const LightDescription light =
            is_sphere ? LightDescription(SphereLight{10 * to_light, 0.5, {1, 1, 1}})
                      : LightDescription(DiskLight{10 * to_light, Vector3d(-1, 0.3, -1), 0.5, {1, 1, 1}});
        std::optional<CoatDescription> coat;
        if (ior > 1) coat = CoatDescription{ior, 0.02};
        const Eigen::Matrix2d lobe = lobe_under(light, 4 * eye, coat);

        const ShadowRays rays(light, {0, 0, 0});
        Eigen::Vector2d sum(0, 0);
        Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();
        constexpr int steps = 60;
        for (int a = 0; a < steps; ++a)
          for (int b = 0; b < steps; ++b) {
            const Vector3d direction =
                rays.to(on_unit_disk({(a + 0.5) / steps, (b + 0.5) / steps})).direction;
            const Vector3d half = (refracted(eye.normalized(), ior) + refracted(direction, ior)).normalized();
            sum += half.head<2>(), squares += half.head<2>() * half.head<2>().transpose();
          }
        constexpr double count = steps * steps;
        const Eigen::Matrix2d truth = squares / count - sum * sum.transpose() / (count * count);
        EXPECT_NEAR(lobe.trace(), truth.trace(), 0.03 * truth.trace())
            << degrees << " " << is_sphere << " " << ior;
        EXPECT_NEAR(lobe.determinant(), truth.determinant(), 0.05 * truth.determinant())
            << degrees << " " << is_sphere << " " << ior;
      }
}

/// What a facet of each normal on the disk, about a place and within `reach` of it, mirrors of queries.
std::vector<double> mirrored(const std::vector<GlintQuery>& queries, const Eigen::Vector2d& about,
                             double reach) {
  constexpr int steps = 30;  // spaced by 0.54 of the roughness or less; 60 give the same four digits
  std::vector<double> sums(steps * steps, 0.0);
  for (const GlintQuery& query : queries) {
    const Eigen::Matrix2d lobe = lobe_covariance(query.query), inverse = lobe.inverse();
    const double scale = query.weight[0] / (2 * kPi * std::sqrt(lobe.determinant()));
    for (int n = 0; n < steps * steps; ++n) {
      const Eigen::Vector2d normal =
          about + reach * (Eigen::Vector2d(n % steps, n / steps) / (0.5 * steps) - Eigen::Vector2d::Ones());
      const Eigen::Vector2d way = normal - query.query.half_vector;
      sums[static_cast<std::size_t>(n)] += scale * std::exp(-0.5 * way.dot(inverse * way));
    }
  }
  return sums;
}

std::vector<LightDescription> points_of(const LightDescription& light) {
  constexpr int steps = 40;
  std::vector<LightDescription> points;
  const ShadowRays rays(light, {0, 0, 0});
  for (int a = 0; a < steps; ++a)
    for (int b = 0; b < steps; ++b) {
      const Eigen::Vector2d on_disk = on_unit_disk({(a + 0.5) / steps, (b + 0.5) / steps});
      const ShadowRay ray = rays.to(on_disk);
      PointLight point{ray.distance * ray.direction};
      double facing = 1;
      if (const auto* disk = std::get_if<DiskLight>(&light)) {
        facing = -ray.direction.dot(disk->direction.normalized());
      } else {  // the outline of a sphere lies nearer than its middle
        const auto& sphere = std::get<SphereLight>(light);
        const double sine = sphere.radius / sphere.position.norm() * on_disk.norm();
        const Vector3d z = sphere.position.normalized(), aside = point.position - point.position.dot(z) * z;
        const Vector3d direction =
            aside.norm() > 0 ? Vector3d(std::sqrt(1 - sine * sine) * z + sine * aside.normalized()) : z;
        point.position = sphere.position.norm() * direction;
        facing = 1 / std::sqrt(1 - sine * sine);
      }
      point.intensity = Color::Constant(facing / (steps * steps));
      points.emplace_back(point);
    }
  return points;
}

// Brute force: 1600 lamps without extent in place of one. Images of lamps from less than one to five lobes
// wide, from above to 75 degrees.
TEST(AreaLights, PartsOfALampShowWhatItsPointsShow) {
  for (const double degrees : {10.0, 50.0, 75.0})
    for (const bool is_sphere : {true, false})
      for (const double wide : {0.8, 2.0, 5.0}) {
        SCOPED_TRACE(testing::Message()
                     << degrees << " degrees, " << wide << " lobes, " << (is_sphere ? "sphere" : "disk"));
        const double angle = degrees * kPi / 180, radius = 1.5;
        const Vector3d to_light(std::sin(angle), 0, std::cos(angle)),
            eye(-std::sin(angle), 0.2, std::cos(angle));
        const LightDescription light =
            is_sphere ? LightDescription(SphereLight{10 * to_light, radius, {1, 1, 1}})
                      : LightDescription(DiskLight{10 * to_light, -to_light, radius, {1, 1, 1}});
        // Half vectors spread most across the plane of both directions.
        const double image = radius / 10 / (2 * std::cos(angle)), roughness = image / wide;
        const auto shown = queries_under({light}, 4 * eye, roughness, {}, LampParts::of(19, 0.01));
        const auto one = queries_under({light}, 4 * eye, roughness, {}, {});
        const auto expected = queries_under(points_of(light), 4 * eye, roughness, {}, {});
        ASSERT_EQ(one.size(), 1U);
        const double reach = image + 3 * roughness;
        const Eigen::Vector2d about = one[0].query.half_vector;
        const std::vector<double> truth = mirrored(expected, about, reach);
        const double error = relative_l2(mirrored(shown, about, reach), truth);
        std::printf("%2.0f degrees, %.1f lobes, %s: %zu queries, relative L2 %.4f, one Gaussian %.4f\n",
                    degrees, wide, is_sphere ? "sphere" : "disk", shown.size(), error,
                    relative_l2(mirrored(one, about, reach), truth));
        EXPECT_LT(error, 0.02) << shown.size() << " queries";
        EXPECT_EQ(shown.size(), wide < 1 ? 1U : wide < 3 ? 7U : 19U);
        if (wide > 3) {
          EXPECT_GT(relative_l2(mirrored(one, about, reach), truth), 0.15);
        }
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
  material.specular = DielectricFresnel{1};  // takes nothing
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
    // What 1 W/sr gives from 2 above, of a disk that is parallel to the ground.
    const double sum = 4 + p.squaredNorm() + 0.01, root = std::sqrt(sum * sum - 4 * 0.01 * p.squaredNorm());
    const double full = (1 - (sum - 2 * 0.01) / root) / (2 * 0.01);
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
