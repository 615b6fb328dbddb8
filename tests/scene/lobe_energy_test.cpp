// Furnaces of lobes that keep what bounces more often, by integrals over the light's directions.
#include "host/scene/lobe_energy.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "host/base/constants.h"
#include "host/microfacet/masking.h"

namespace mica::host::lobe_energy_test {
namespace {

using Vector3d = Eigen::Vector3d;

Vector3d direction(double polar_degrees, double azimuth_degrees) {
  const double polar = polar_degrees * kPi / 180, azimuth = azimuth_degrees * kPi / 180;
  return {std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), std::cos(polar)};
}

/// Integral of D G / 4 o.z over the normals of the hemisphere, of which each mirrors the view to a light.
double furnace(const Vector3d& view, const std::function<double(const Vector3d&)>& density,
               const std::function<double(const Vector3d&, const Vector3d&)>& masking) {
  constexpr int steps = 250;
  double sum = 0;
  for (int j = 0; j < steps; ++j)
    for (int k = 0; k < 2 * steps; ++k) {
      // Even steps of the polar angle's square root: most normals are near the pole.
      const double x = (j + 0.5) / steps, polar = kPi / 2 * x * x, azimuth = kPi * (k + 0.5) / steps;
      const Vector3d half(std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth),
                          std::cos(polar));
      const double facing = view.dot(half);
      const Vector3d light = 2 * facing * half - view;
      if (facing <= 0 || light.z() <= 0) continue;
      const double area = std::sin(polar) * kPi * x / steps * kPi / steps;  // of this part of the hemisphere
      sum += area * density(half) * masking(view, light) * facing / view.z();
    }
  return sum;
}

TEST(LobeEnergy, MakesFurnacesOfAMapsRoughnessWhite) {
  for (const double roughness : {0.1, 0.4}) {
    MaterialDescription material;
    material.roughness = roughness;
    const double alpha = std::sqrt(2.0) * roughness;
    const LobeEnergy energy(material, SmoothLobe(alpha));
    for (const double polar : {0.0, 30.0, 60.0, 75.0, 85.0}) {
      const Vector3d view = direction(polar, 20);
      const double single = furnace(
          view,
          [&](const Vector3d& half) {  // a Gaussian on the disk
            return std::exp(-half.head<2>().squaredNorm() / (2 * roughness * roughness)) /
                   (2 * kPi * roughness * roughness);
          },
          [&](const Vector3d& o, const Vector3d& i) { return smith_masking_shadowing(o.z(), i.z(), alpha); });
      EXPECT_NEAR(single * energy.factor(view).x(), 1, 0.01) << roughness << ' ' << polar << ": " << single;
    }
  }
}

TEST(LobeEnergy, MakesFurnacesOfGlintsWhite) {
  for (const Distribution distribution : {Distribution::beckmann, Distribution::trowbridge_reitz}) {
    MaterialDescription material;
    material.roughness = 1e-3;
    material.glints.emplace();
    material.glints->distribution = distribution;
    const SmoothLobe lobe(*material.glints, {0.6, 0.2});
    const LobeEnergy energy(material, lobe);
    for (const double polar : {10.0, 45.0, 75.0, 85.0})
      for (const double azimuth : {0.0, 50.0, 90.0, 250.0}) {
        const Vector3d view = direction(polar, azimuth);
        const double single = furnace(
            view, [&](const Vector3d& half) { return lobe.density(half); },
            [&](const Vector3d& o, const Vector3d& i) { return lobe.masking_shadowing(o, i); });
        EXPECT_LT(single, 1.001);
        EXPECT_NEAR(single * energy.factor(view).x(), 1, 0.01) << polar << ' ' << azimuth << ": " << single;
      }
  }
}

TEST(LobeEnergy, ColorsWhatBouncesMoreOften) {
  MaterialDescription material;
  material.roughness = 0.5;
  material.specular = ColorFresnel{{1, 0.5, 0}};
  const Vector3d view = direction(60, 0);
  const LobeEnergy energy(material, SmoothLobe(std::sqrt(0.5)));
  const double more = (1 - energy.albedo(view)) / energy.albedo(view);
  EXPECT_GT(more, 0.02);
  EXPECT_TRUE(energy.factor(view).isApprox(Color(1 + more, 1 + more / 2, 1), 1e-12));
}

}  // namespace
}  // namespace mica::host::lobe_energy_test
