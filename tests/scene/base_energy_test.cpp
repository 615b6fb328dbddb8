// How a material's lobes share the light: no more than all is returned, and below a coat as much as by a
// random walk between the two.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

#include "host/base/constants.h"
#include "host/scene/fresnel.h"
#include "host/scene/lobes.h"

namespace mica::host::base_energy_test {
namespace {

using Eigen::Vector3d;

Vector3d direction(double degrees, double azimuth = 0) {
  const double polar = degrees * kPi / 180;
  return {std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), std::cos(polar)};
}

MaterialDescription material_of(const Fresnel& specular, double albedo, double coat_ior = 0) {
  MaterialDescription material;
  material.specular = specular;
  material.diffuse = Color::Constant(albedo);
  if (coat_ior > 0) material.coat = CoatDescription{coat_ior, 0.02};
  return material;
}

/// Density of a Beckmann lobe of normals. [Che18] Eq. 4, centred
double beckmann(const Vector3d& h, double alpha) {
  const double cos2 = h.z() * h.z();
  return std::exp(-(1 / cos2 - 1) / (alpha * alpha)) / (kPi * alpha * alpha * cos2 * cos2);
}

/// What a white furnace shows of a material whose map is one Beckmann lobe, all but the coat's own
/// reflection.
struct Returned {
  Color mirrored = Color::Zero(), diffuse = Color::Zero();
};
Returned returned(const LayeredMaterial& layers, const Vector3d& view) {
  constexpr int rings = 250, sectors = 125;  // sectors of half a turn: both are alike
  Returned sum;
  for (int y = 0; y < rings; ++y)
    for (int x = 0; x < sectors; ++x) {
      const double z = (y + 0.5) / rings, r = std::sqrt(1 - z * z), azimuth = kPi * (x + 0.5) / sectors;
      const Vector3d light(r * std::cos(azimuth), r * std::sin(azimuth), z);
      const double area = 2 * kPi / (rings * sectors);
      const LobesSeen seen = see_lobes(layers, Vector3d::UnitZ(), view, {light, 1, Color::Ones()});
      sum.mirrored += area * beckmann(seen.half_vector, layers.masking_alpha) * seen.glint_weight;
      sum.diffuse += area * z * layers.energy.diffuse(view.z(), z);
    }
  return sum;
}

TEST(BaseEnergy, NeverReturnsMoreThanAll) {
  double most = 0;
  for (const Fresnel& specular : {Fresnel(DielectricFresnel{1.5}), Fresnel(DielectricFresnel{2.5}),
                                  Fresnel(ColorFresnel{{0.04, 0.3, 0.9}}), Fresnel(ConductorFresnel{})})
    for (const double alpha : {0.1, 0.3, 0.7}) {
      const LayeredMaterial layers(material_of(specular, 1), alpha);
      for (const double degrees : {0.0, 30.0, 50.0, 65.0, 75.0, 85.0}) {
        const Returned sum = returned(layers, direction(degrees));
        most = std::max(most, (sum.mirrored + sum.diffuse).maxCoeff());
        EXPECT_LE((sum.mirrored + sum.diffuse).maxCoeff(), 1.005) << alpha << " " << degrees;
        EXPECT_GE((sum.mirrored + sum.diffuse).minCoeff(), alpha < 0.2 && degrees < 80 ? 0.97 : 0.6)
            << alpha << " " << degrees;
      }
    }
  std::printf("at most %.4f of the light\n", most);
}

/// Smooth: Fresnel's own factor goes to the mirror, the rest to the white base, from every angle.
TEST(BaseEnergy, DiffuseLobeGetsWhatASmoothMirrorLeaves) {
  constexpr int steps = 2000;
  const LayeredMaterial layers(material_of(DielectricFresnel{1.5}, 1), 1e-3);
  for (const double degrees : {0.0, 40.0, 60.0, 80.0, 85.0}) {
    const double cos_o = direction(degrees).z();
    double albedo = 0;
    for (int n = 0; n < steps; ++n) {
      const double cos_i = (n + 0.5) / steps;
      albedo += 2 * kPi * cos_i / steps * layers.energy.diffuse(cos_o, cos_i)[0];
      EXPECT_EQ(layers.energy.diffuse(cos_o, cos_i), layers.energy.diffuse(cos_i, cos_o));
    }
    EXPECT_NEAR(albedo, 1 - dielectric_reflectance(cos_o, 1.5), 2e-3) << degrees;
  }
  // Nothing is left below a perfect mirror, and all below nothing.
  EXPECT_EQ(LayeredMaterial(material_of(ColorFresnel{}, 1), 0.3).energy.diffuse(0.5, 0.7), Color::Zero());
  const LayeredMaterial chalk(material_of(DielectricFresnel{1}, 0.6), 0.3);
  EXPECT_NEAR(chalk.energy.diffuse(0.5, 0.7)[0], 0.6 / kPi, 1e-12);
}

/// [Heitz14] Eq. 66, by its definition.
double lambda(double cosine, double alpha) {
  const double a = cosine / (alpha * std::sqrt(std::max(1e-30, 1 - cosine * cosine)));
  return (std::erf(a) - 1) / 2 + std::exp(-a * a) / (2 * a * std::sqrt(kPi));
}

/// A ray from `view` goes to and fro between a flat interface and a base of Beckmann normals, masked after
/// [Heitz14] Eq. 99, until it leaves. @return the mean of what is left of it then.
Color walk(const Fresnel& base, double ior, double alpha, double cos_view, int walks) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> normal(0, alpha / std::sqrt(2.0));
  Color sum = Color::Zero();
  for (int n = 0; n < walks; ++n) {
    Color left = Color::Constant(1 - dielectric_reflectance(cos_view, ior));
    const double sine = std::sqrt(1 - cos_view * cos_view) / ior;
    Vector3d o(sine, 0, std::sqrt(1 - sine * sine));
    for (int bounce = 0; bounce < 200 && left.maxCoeff() > 1e-4; ++bounce) {
      const Vector3d h = Vector3d(-normal(random), -normal(random), 1).normalized();
      const Vector3d i = 2 * o.dot(h) * h - o;
      if (o.dot(h) <= 0 || i.z() <= 0) {
        left.setZero();
        break;
      }
      const double G = 1 / (1 + lambda(o.z(), alpha) + lambda(i.z(), alpha));
      left = left.cwiseProduct(reflectance(base, o.dot(h))) * (G * o.dot(h) / (h.z() * o.z()));
      const double sine2 = ior * ior * (1 - i.z() * i.z());
      const double leaves = sine2 < 1 ? 1 - dielectric_reflectance(std::sqrt(1 - sine2), ior) : 0;
      sum += leaves * left / walks;
      left *= 1 - leaves;
      o = i;
    }
  }
  return sum;
}

TEST(BaseEnergy, CoatedBaseReturnsWhatAWalkDoes) {
  const Fresnel gold = ConductorFresnel{};
  for (const double ior : {1.33, 1.6})
    for (const double alpha : {0.1, 0.3, 0.6}) {
      double worst = 0, single = 0;
      for (const double degrees : {0.0, 30.0, 50.0, 65.0, 75.0}) {
        const Vector3d view = direction(degrees);
        const LayeredMaterial layers(material_of(gold, 0, ior), alpha);
        const Color expected = walk(below(gold, ior), ior, alpha, view.z(), 50000);
        const Color found = returned(layers, view).mirrored;
        worst = std::max(worst, (found - expected).cwiseQuotient(expected).cwiseAbs().maxCoeff());
        single = std::max(single, 1 - 1 / layers.energy.interreflection(view.z(), view.z())[0]);
      }
      std::printf("coat %.2f, alpha %.1f: off by %.3f at most, %.3f without interreflection\n", ior, alpha,
                  worst, single);
      EXPECT_LT(worst, 0.025);
    }
}

TEST(BaseEnergy, CoatedBaseNeverReturnsMoreThanAll) {
  double most = 0;
  for (const Fresnel& specular : {Fresnel(DielectricFresnel{1.8}), Fresnel(ColorFresnel{{0.1, 0.5, 1}})})
    for (const double alpha : {0.1, 0.4})
      for (const double degrees : {0.0, 45.0, 70.0, 85.0}) {
        const Vector3d view = direction(degrees);
        const Returned sum = returned(LayeredMaterial(material_of(specular, 1, 1.5), alpha), view);
        const double all = (sum.mirrored + sum.diffuse).maxCoeff() + dielectric_reflectance(view.z(), 1.5);
        most = std::max(most, all);
        EXPECT_LE(all, 1.005) << alpha << " " << degrees;
      }
  std::printf("at most %.4f of the light\n", most);
}

}  // namespace
}  // namespace mica::host::base_energy_test
