// The clear coat: Snell's and Fresnel's closed forms, and the energy that it keeps.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "host/base/constants.h"
#include "host/scene/fresnel.h"
#include "host/scene/lobes.h"

namespace mica::host::coat_test {
namespace {

using Eigen::Vector3d;

const Vector3d kUp = Vector3d::UnitZ();

Vector3d direction(double cosine, double azimuth = 0) {
  const double sine = std::sqrt(1 - cosine * cosine);
  return {sine * std::cos(azimuth), sine * std::sin(azimuth), cosine};
}

TEST(Coat, RefractsBySnell) {
  for (const double ior : {1.1, 1.5, 2.4}) {
    const CoatInterface coat({ior, 0.02});
    for (const double degrees : {0.0, 10.0, 45.0, 80.0, 89.9}) {
      const double angle = degrees * kPi / 180;
      const Vector3d inside = coat.refracted(direction(std::cos(angle), 0.7), kUp);
      EXPECT_NEAR(inside.norm(), 1, 1e-14);
      EXPECT_NEAR(std::hypot(inside.x(), inside.y()) * ior, std::sin(angle), 1e-14);
      EXPECT_NEAR(std::atan2(inside.y(), inside.x()), degrees > 0 ? 0.7 : 0.0, 1e-9);
    }
  }
}

MaterialDescription coated(double ior, const Fresnel& specular, const Color& diffuse = Color::Zero()) {
  MaterialDescription material;
  material.specular = specular, material.diffuse = diffuse;
  material.coat = CoatDescription{ior, 0.02};
  return material;
}

/// Light from `cos_i` that a diffuse lobe returns, over all directions.
double diffuse_albedo(const LayeredMaterial& layers, double cos_i) {
  constexpr int steps = 4000;
  double albedo = 0;
  for (int n = 0; n < steps; ++n) {
    const double cos_o = (n + 0.5) / steps;
    albedo += 2 * kPi * cos_o * layers.energy.diffuse(cos_o, cos_i)[0] / steps;
  }
  return albedo;
}

// A white base under a coat that absorbs nothing sends back all that enters: what it reflects and what the
// interface reflects are one together, for every direction of the light. Of a grey base the series of all
// bounces, with the reflectance of the interface for diffuse light from below, which is that from above by
// reciprocity.
TEST(Coat, DiffuseBaseIsTheSeriesOfItsBounces) {
  for (const double ior : {1.05, 1.5, 2.0}) {
    double outer = 0;
    constexpr int steps = 4096;
    for (int n = 0; n < steps; ++n) {
      const double cosine = (n + 0.5) / steps;
      outer += 2 * cosine * dielectric_reflectance(cosine, ior) / steps;
    }
    const double inner = 1 - (1 - outer) / (ior * ior);
    for (const double albedo : {1.0, 0.5, 0.1}) {
      // The base's own boundary reflects nothing: its index is that of the coat.
      const LayeredMaterial layers(coated(ior, DielectricFresnel{ior}, Color::Constant(albedo)), 0.1);
      for (const double cos_i : {1.0, 0.6, 0.1}) {
        const double entering = 1 - dielectric_reflectance(cos_i, ior);
        const double expected = entering * albedo * (1 - inner) / (1 - albedo * inner);
        EXPECT_NEAR(diffuse_albedo(layers, cos_i), expected, 1e-4) << ior << " " << albedo << " " << cos_i;
      }
    }
  }
}

/// Density of a Beckmann lobe at a half vector on the disk, and what a lobe of it sends back of light from
/// `light`, over the directions about its mirror image, by their projection on the plane: d omega cos_o = dx
/// dy.
double beckmann_density(const Eigen::Vector2d& h, double sigma) {
  const double cos2 = 1 - h.squaredNorm();
  return std::exp(-h.squaredNorm() / cos2 / (2 * sigma * sigma)) / (2 * kPi * sigma * sigma * cos2 * cos2);
}
Color mirrored_energy(const LayeredMaterial& layers, double sigma, const Vector3d& light, double reach) {
  constexpr int steps = 400;
  Color energy = Color::Zero();
  for (int a = 0; a < steps; ++a)
    for (int b = 0; b < steps; ++b) {
      const double x = -light.x() + reach * (2 * (a + 0.5) / steps - 1),
                   y = -light.y() + reach * (2 * (b + 0.5) / steps - 1);
      if (x * x + y * y >= 1) continue;
      const Vector3d eye(x, y, std::sqrt(1 - x * x - y * y));
      const LobesSeen seen = see_lobes(layers, kUp, eye, {light, 1, Color::Ones()});
      energy += beckmann_density(seen.half_vector.head<2>(), sigma) * seen.glint_weight;
    }
  return energy * std::pow(2 * reach / steps, 2) / light.z();
}

// Below the coat a mirror of smooth normals: light leaves in the direction of the mirror, weakened by two
// crossings, and again after every two bounces: T^2 r / (1 - (1 - T) r), all of what enters if the mirror is
// perfect. Its factor r is that of the base's index over the coat's.
TEST(Coat, SmoothMirrorBelowIsTheSeriesOfItsBounces) {
  constexpr double ior = 1.5, sigma = 0.004;
  const Fresnel gold = ConductorFresnel{},
                gold_in_coat = ConductorFresnel{Color(0.2, 0.92, 1.1) / ior, Color(3.9, 2.45, 2.1) / ior};
  for (const double cos_i : {0.95, 0.7, 0.3}) {
    const Vector3d light = direction(cos_i);
    const double crossed = 1 - dielectric_reflectance(cos_i, ior),
                 cos_below = std::sqrt(1 - (1 - cos_i * cos_i) / (ior * ior));
    const LayeredMaterial mirror(coated(ior, ColorFresnel{}), std::sqrt(2.0) * sigma);
    EXPECT_NEAR(mirrored_energy(mirror, sigma, light, 0.1)[0], crossed, 3e-3) << cos_i;
    const LayeredMaterial base(coated(ior, gold), std::sqrt(2.0) * sigma);
    const Color r = reflectance(gold_in_coat, cos_below), found = mirrored_energy(base, sigma, light, 0.1);
    for (int channel = 0; channel < 3; ++channel) {
      const double series = crossed * crossed * r[channel] / (1 - (1 - crossed) * r[channel]);
      EXPECT_NEAR(found[channel], series, 3e-3) << cos_i << ", channel " << channel;
    }
  }
  const LayeredMaterial same(coated(ior, DielectricFresnel{ior}), 0.1);
  EXPECT_EQ(see_lobes(same, kUp, direction(0.9), {direction(0.8), 1, Color::Ones()}).glint_weight,
            Color::Zero());
}

TEST(Coat, ReflectsAsMuchAsItsFresnelFactor) {
  const CoatInterface coat({1.5, 0.01});
  const double cos_i = 0.8;
  const Vector3d light = direction(cos_i);
  constexpr int steps = 400;
  double energy = 0;
  for (int a = 0; a < steps; ++a)
    for (int b = 0; b < steps; ++b) {
      const double x = -light.x() + 0.15 * (2 * (a + 0.5) / steps - 1),
                   y = 0.15 * (2 * (b + 0.5) / steps - 1);
      if (x * x + y * y >= 1) continue;
      const Vector3d eye(x, y, std::sqrt(1 - x * x - y * y));
      energy += coat.reflection(kUp, eye, light, 0);
    }
  energy *= std::pow(0.3 / steps, 2);
  EXPECT_NEAR(energy / cos_i, dielectric_reflectance(cos_i, 1.5), 1e-3);
}

/// What a smooth coat over nothing shows of a lamp at a place of the plane.
double shown(const LayeredMaterial& coat, const LightDescription& lamp, const Vector3d& place,
             const Vector3d& eye) {
  const Illumination seen = illuminate(lamp, place);
  return seen.irradiance[0] * see_lobes(coat, kUp, eye, seen).smooth[0];
}

// A mirror shows the lamp itself, as bright as Fresnel's factor leaves it: a disk of F L pi r^2 / cos_o on
// the plane, and nothing beside it. The Gaussian of the coat's own slopes blurs its rim.
TEST(Coat, MirrorsALampAndNothingBesideIt) {
  MaterialDescription smooth = coated(1.5, DielectricFresnel{1.5});
  smooth.coat->roughness = 2e-3;
  const LayeredMaterial coat(smooth, 0.1);
  for (const double radius : {0.5, 1.95}) {
    const SphereLight lamp{{0, 0, 5}, radius, {1, 1, 1}};
    for (const double degrees : {0.0, 30.0, 60.0, 70.0}) {
      const Vector3d eye = direction(std::cos(degrees * kPi / 180), 0.3),
                     mirrored(-eye.x(), -eye.y(), eye.z());
      constexpr int steps = 600;
      const double reach = 3 * radius / eye.z() + 2, step = 2 * reach / steps;
      const Vector3d middle = Vector3d(0, 0, 5) - 5 / mirrored.z() * mirrored;
      double sum = 0, beside = 0;
      for (int n = 0; n < steps * steps; ++n) {
        const Vector3d place =
            middle + Vector3d((n % steps + 0.5) * step - reach, (n / steps + 0.5) * step - reach, 0);
        const double value = shown(coat, lamp, place, eye) * step * step;
        const double miss = (Vector3d(0, 0, 5) - place).cross(mirrored).norm();
        sum += value;
        if (miss > 1.5 * radius) beside += value;
      }
      const double expected = dielectric_reflectance(eye.z(), 1.5) / eye.z();  // L = 1 / (pi r^2)
      EXPECT_NEAR(sum / expected, 1, 5e-3) << radius << " " << degrees;
      EXPECT_LT(beside / expected, 1e-3) << radius << " " << degrees;
    }
  }
}

TEST(Coat, QueriesLieBelowTheInterface) {
  MaterialDescription paint;
  paint.roughness = 0.01;
  paint.coat = CoatDescription{1.5, 0.02};
  const Vector3d eye = direction(0.7, 0.2);
  const Illumination light{direction(0.5, 2.0), 1, Color::Ones()};
  const LobesSeen seen = see_lobes(LayeredMaterial(paint, 0.1), kUp, eye, light);
  const Vector3d expected =
      (direction(std::sqrt(1 - 0.51 / 2.25), 0.2) + direction(std::sqrt(1 - 0.75 / 2.25), 2.0)).normalized();
  EXPECT_NEAR((seen.half_vector - expected).norm(), 0, 1e-12);
  EXPECT_EQ(seen.roughness, 0.01);
  EXPECT_GT(seen.glint_weight.minCoeff(), 0);
}

}  // namespace
}  // namespace mica::host::coat_test
