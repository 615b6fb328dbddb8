#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <complex>

#include "host/base/constants.h"
#include "host/microfacet/masking.h"
#include "host/scene/fresnel.h"
#include "host/scene/lobes.h"

namespace mica::host::brdf_test {
namespace {

TEST(DielectricReflectance, HasItsClosedForms) {
  for (const double n : {1.1, 1.5, 2.4}) {
    EXPECT_NEAR(dielectric_reflectance(1, n), std::pow((n - 1) / (n + 1), 2), 1e-15);
    // At Brewster's angle only the perpendicular half of the light is reflected.
    const double cos_brewster = 1 / std::sqrt(1 + n * n);
    EXPECT_NEAR(dielectric_reflectance(cos_brewster, n), std::pow((n * n - 1) / (n * n + 1), 2) / 2, 1e-15);
    EXPECT_NEAR(dielectric_reflectance(0, n), 1, 1e-15);
  }
  EXPECT_NEAR(dielectric_reflectance(0.3, 1), 0, 1e-30) << "no boundary";
  EXPECT_EQ(dielectric_reflectance(std::cos(0.75), 1 / 1.5), 1) << "beyond the critical angle of 0.7297";
  EXPECT_LT(dielectric_reflectance(std::cos(0.70), 1 / 1.5), 1);
}

TEST(ConductorReflectance, HasItsClosedForms) {
  for (const double eta : {0.2, 1.1, 3.0})
    for (const double k : {0.5, 3.9})
      EXPECT_NEAR(conductor_reflectance(1, eta, k),
                  (std::pow(eta - 1, 2) + k * k) / (std::pow(eta + 1, 2) + k * k), 1e-15);
  for (double cos_i = 0; cos_i <= 1; cos_i += 0.05)
    EXPECT_NEAR(conductor_reflectance(cos_i, 1.5, 0), dielectric_reflectance(cos_i, 1.5), 1e-14) << cos_i;
  EXPECT_NEAR(conductor_reflectance(0, 0.2, 3.9), 1, 1e-15);
  EXPECT_NEAR(conductor_reflectance(0.5, 1, 1e6), 1, 1e-5) << "a perfect conductor";
}

TEST(ConductorReflectance, AgreesWithComplexAmplitudes) {
  for (const double eta : {0.05, 0.92, 2.7})
    for (const double k : {0.0, 0.3, 2.45})
      for (double cos_i = 0.01; cos_i <= 1; cos_i += 0.03) {
        const std::complex<double> n(eta, k);
        const std::complex<double> cos_t = std::sqrt(1.0 - (1 - cos_i * cos_i) / (n * n));
        const double r_s = std::norm((cos_i - n * cos_t) / (cos_i + n * cos_t));
        const double r_p = std::norm((n * cos_i - cos_t) / (n * cos_i + cos_t));
        EXPECT_NEAR(conductor_reflectance(cos_i, eta, k), (r_s + r_p) / 2, 1e-12)
            << eta << " " << k << " " << cos_i;
      }
}

TEST(Reflectance, IsThatOfEachChannel) {
  const ConductorFresnel copper;
  const Color metal = reflectance(copper, 0.7);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(metal[i], conductor_reflectance(0.7, copper.eta[i], copper.k[i]));
  EXPECT_EQ(reflectance(DielectricFresnel{1.5}, 0.7), Color::Constant(dielectric_reflectance(0.7, 1.5)));
  const Color schlick = reflectance(ColorFresnel{{0.2, 0.5, 1}}, 0.5);
  EXPECT_TRUE(schlick.isApprox(Color(0.2 + 0.8 / 32, 0.5 + 0.5 / 32, 1), 1e-15));
  for (const double outside : {-1e-9, 1 + 1e-9})
    EXPECT_TRUE(reflectance(copper, outside).allFinite() && reflectance(copper, outside).maxCoeff() <= 1);
}

/// Lambda from its definition: the mean height by which slopes along the ray exceed the ray's own. [Heitz14]
/// sec. 5.
double lambda_by_integration(double cos_theta, double alpha) {
  const double cotangent = cos_theta / std::sqrt(1 - cos_theta * cos_theta), end = cotangent + 10 * alpha;
  const int steps = 200000;
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double slope = cotangent + (end - cotangent) * (i + 0.5) / steps;
    sum += (slope - cotangent) * std::exp(-slope * slope / (alpha * alpha)) / (alpha * std::sqrt(kPi));
  }
  return sum * (end - cotangent) / steps / cotangent;
}

TEST(BeckmannLambda, AgreesWithItsDefinition) {
  for (const double alpha : {0.05, 0.3, 1.0})
    for (const double cos_theta : {0.01, 0.1, 0.3, 0.6, 0.9}) {
      const double expected = lambda_by_integration(cos_theta, alpha);
      EXPECT_NEAR(beckmann_lambda(cos_theta, alpha), expected, 1e-6 * expected + 1e-12)
          << alpha << " " << cos_theta;
    }
}

TEST(BeckmannLambda, HasItsLimits) {
  EXPECT_EQ(beckmann_lambda(1, 0.5), 0);
  EXPECT_EQ(beckmann_lambda(0.001, 0), 0) << "a flat surface hides nothing";
  // Near the horizon Lambda -> alpha tan / (2 sqrt(kPi)) - 1/2.
  EXPECT_NEAR(beckmann_lambda(1e-8, 0.2) * 1e-8, 0.2 / (2 * std::sqrt(kPi)), 1e-8);
}

TEST(SmithMaskingShadowing, IsSymmetricBoundedAndVanishesAtTheHorizon) {
  EXPECT_EQ(smith_masking_shadowing(1, 1, 0.3), 1);
  for (double o = 0.05; o <= 1; o += 0.19)
    for (double i = 0.05; i <= 1; i += 0.19) {
      const double G = smith_masking_shadowing(o, i, 0.4);
      EXPECT_DOUBLE_EQ(G, smith_masking_shadowing(i, o, 0.4));
      EXPECT_GT(G, 0);
      EXPECT_LE(G, 1);
    }
  EXPECT_LT(smith_masking_shadowing(1e-9, 0.5, 0.1), 1e-7);
  EXPECT_NEAR(smith_masking_shadowing(1e-9, 1, 0.1) / 1e-9, 2 * std::sqrt(kPi) / 0.1, 1e-5);
}

TEST(GlintWeight, IsTheMicrofacetModelWithoutItsNdf) {
  const Eigen::Vector3d n = Eigen::Vector3d::UnitZ();
  MaterialDescription material;
  material.specular = ColorFresnel{{0.3, 0.6, 0.9}};
  const auto weight = [&](double alpha, const Eigen::Vector3d& to_eye, const Eigen::Vector3d& to_light) {
    return see_lobes(LayeredMaterial(material, alpha), n, to_eye, {to_light, 1, Color::Ones()}).glint_weight;
  };
  EXPECT_TRUE(weight(0.1, n, n).isApprox(Color(0.3, 0.6, 0.9) / 4, 1e-15));

  // Light at 60 degrees from the normal on one side, eye at 30 on the other: half vector 15 degrees off, 45
  // from both.
  const double third = kPi / 3, sixth = kPi / 6;
  const Eigen::Vector3d i(std::sin(third), 0, std::cos(third)), o(-std::sin(sixth), 0, std::cos(sixth));
  const double schlick = std::pow(1 - std::cos(kPi / 4), 5);
  const double G = 1 / (1 + beckmann_lambda(std::cos(third), 0.5) + beckmann_lambda(std::cos(sixth), 0.5));
  const double shape = G / (4 * std::cos(sixth) * std::cos(third)) * std::cos(third);
  const Color expected = shape * Color(0.3 + 0.7 * schlick, 0.6 + 0.4 * schlick, 0.9 + 0.1 * schlick);
  EXPECT_TRUE(weight(0.5, o, i).isApprox(expected, 1e-13));
}

}  // namespace
}  // namespace mica::host::brdf_test
