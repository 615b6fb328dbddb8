// The clear coat: Snell's and Fresnel's closed forms, and the energy that it keeps.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "host/base/constants.h"
#include "host/scene/coat.h"
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

// A white base under a coat that absorbs nothing sends back all that enters: what it reflects and what the
// interface reflects are one together, for every direction of the light.
TEST(Coat, WhiteBaseLosesNothing) {
  for (const double ior : {1.05, 1.5, 2.0}) {
    const CoatInterface coat({ior, 0.02});
    for (const double cos_i : {1.0, 0.6, 0.1}) {
      constexpr int steps = 20000;
      double albedo = 0;
      for (int n = 0; n < steps; ++n) {
        const double cos_o = (n + 0.5) / steps;
        albedo += 2 * kPi * cos_o * coat.diffuse(Color::Ones(), cos_o, cos_i)[0] / steps;
      }
      EXPECT_NEAR(albedo + dielectric_reflectance(cos_i, ior), 1, 1e-5) << ior << " " << cos_i;
    }
  }
}

// Inside the coat a mirror of smooth normals: light leaves in the direction of the mirror, and its radiance
// is that of the light twice weakened by the interface. Checked as energy: the integral over directions of a
// narrow lobe, with D a Gaussian of the half vector below.
TEST(Coat, NarrowLobeBelowKeepsWhatCrossesTwice) {
  const double ior = 1.5, sigma = 0.004;
  const CoatInterface coat({ior, 0.02});
  for (const double cos_i : {0.95, 0.7}) {
    const Vector3d light = direction(cos_i), mirror(-light.x(), -light.y(), light.z());
    constexpr int steps = 400;
    const double reach = 0.1;
    double energy = 0;
    for (int a = 0; a < steps; ++a)
      for (int b = 0; b < steps; ++b) {
        // Directions by their projection on the plane: d omega cos_o = dx dy.
        const double x = mirror.x() + reach * (2 * (a + 0.5) / steps - 1),
                     y = reach * (2 * (b + 0.5) / steps - 1);
        if (x * x + y * y >= 1) continue;
        const Vector3d eye(x, y, std::sqrt(1 - x * x - y * y));
        const Vector3d half = (coat.refracted(eye, kUp) + coat.refracted(light, kUp)).normalized();
        const double D =
            std::exp(-half.head<2>().squaredNorm() / (2 * sigma * sigma)) / (2 * kPi * sigma * sigma);
        energy += D * coat.glint_weight(ColorFresnel{}, 0, kUp, eye, light)[0];
      }
    energy *= std::pow(2 * reach / steps, 2);
    const double crossed = 1 - dielectric_reflectance(cos_i, ior);
    EXPECT_NEAR(energy / cos_i, crossed * crossed, 2e-3) << cos_i;
  }
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

TEST(Coat, QueriesLieBelowTheInterface) {
  MaterialDescription paint;
  paint.roughness = 0.01;
  paint.coat = CoatDescription{1.5, 0.02};
  const CoatInterface coat(*paint.coat);
  const Vector3d eye = direction(0.7, 0.2);
  const Illumination light{direction(0.5, 2.0), 1, Color::Ones()};
  const LobesSeen seen = see_lobes(paint, coat, 0.1, kUp, eye, light);
  const Vector3d expected =
      (direction(std::sqrt(1 - 0.51 / 2.25), 0.2) + direction(std::sqrt(1 - 0.75 / 2.25), 2.0)).normalized();
  EXPECT_NEAR((seen.half_vector - expected).norm(), 0, 1e-12);
  EXPECT_EQ(seen.roughness, 0.01);
  EXPECT_GT(seen.glint_weight.minCoeff(), 0);
}

}  // namespace
}  // namespace mica::host::coat_test
