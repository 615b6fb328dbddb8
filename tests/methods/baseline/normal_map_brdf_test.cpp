#include "host/methods/baseline/normal_map_brdf.h"
#include "host/base/constants.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "host/base/random.h"

namespace mica::host::normal_map_brdf_test {
namespace {

/// One normal everywhere, tilted by `angle` from +z towards +x.
Surface tilted(double angle) {
  return Surface(4, 4, Interpolation::bilinear,
                 std::vector<Eigen::Vector2d>(16, Eigen::Vector2d(std::sin(angle), 0)));
}

Eigen::Vector3d direction(double z, double azimuth) {
  const double radius = std::sqrt(1 - z * z);
  return {radius * std::cos(azimuth), radius * std::sin(azimuth), z};
}

const Footprint kFootprint{{0.3, 0.6}, Eigen::Matrix2d::Identity() * 1e-4};

TEST(NormalMapBrdf, IsASmoothLobeAboutTheMapsNormal) {
  const double r = 0.1, angle = 0.3;
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()).toRotationMatrix();
  NormalMapBrdf flat(tilted(0)), turned(tilted(angle));
  const Eigen::Vector3d view = direction(0.9, 0.4);
  for (const Eigen::Vector3d& light : {direction(0.85, 3.3), direction(0.8, 2.5), direction(0.95, -1)}) {
    // A density of slopes over cos^4, at directions from which nothing of this roughness is masked.
    const Eigen::Vector3d half = (view + light).normalized();
    const double slope2 = half.head<2>().squaredNorm() / (half.z() * half.z());
    const double D = std::exp(-slope2 / (2 * r * r)) / (2 * kPi * r * r) / std::pow(half.z(), 4);
    const double expected = D / (4 * view.z());
    EXPECT_NEAR(flat.evaluate({{kFootprint, view, light, r}})[0].single, expected, 1e-5 * expected);
    EXPECT_NEAR(turned.evaluate({{kFootprint, turn * view, turn * light, r}})[0].single, expected,
                1e-5 * expected);
  }
}

TEST(NormalMapBrdf, NothingFromBelowEitherHorizon) {
  NormalMapBrdf brdf(tilted(0.5));
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ(), low_behind = direction(0.2, kPi);
  EXPECT_EQ(brdf.evaluate({{kFootprint, up, low_behind, 0.3}})[0].single, 0);
  EXPECT_EQ(brdf.evaluate({{kFootprint, low_behind, up, 0.3}})[0].single, 0);
  EXPECT_EQ(brdf.evaluate({{kFootprint, up, direction(-0.1, 0), 0.3}})[0].single, 0);
  EXPECT_EQ(brdf.sample({{{kFootprint, low_behind, 0.3}, 1}})[0].pdf, 0);
  EXPECT_GT(brdf.evaluate({{kFootprint, up, direction(0.2, 0), 0.3}})[0].single, 0);
}

/// What tilting takes: draws against a quadrature of `evaluate` over the hemisphere.
TEST(NormalMapBrdf, DrawsFindTheSameAlbedoAsAQuadrature) {
  constexpr int rings = 400, sectors = 800, draws = 40000;
  for (const double angle : {0.0, 0.5}) {
    NormalMapBrdf brdf(tilted(angle));
    const Eigen::Vector3d view = direction(0.6, 0.2);
    std::vector<BrdfQuery> questions;
    for (int j = 0; j < rings; ++j)
      for (int k = 0; k < sectors; ++k)
        questions.push_back(
            {kFootprint, view, direction((j + 0.5) / rings, 2 * kPi * (k + 0.5) / sectors), 0.25});
    double quadrature = 0, densities = 0;
    for (const BrdfValue& value : brdf.evaluate(questions))
      quadrature += static_cast<double>(value.single), densities += static_cast<double>(value.pdf);
    quadrature *= 2 * kPi / (rings * sectors), densities *= 2 * kPi / (rings * sectors);

    std::vector<SampleQuery> keys;
    for (int n = 0; n < draws; ++n)
      keys.push_back({{kFootprint, view, 0.25}, random_bits(5, 0, static_cast<std::uint64_t>(n))});
    double sum = 0, squares = 0, kept = 0;
    for (const BrdfSample& sample : brdf.sample(keys)) {
      const double weight = static_cast<double>(sample.weight_single);
      sum += weight, squares += weight * weight, kept += sample.pdf > 0;
    }
    const double mean = sum / draws, error = std::sqrt((squares / draws - mean * mean) / draws);
    EXPECT_NEAR(mean, quadrature, 4.5 * error + 1e-4) << angle;
    EXPECT_NEAR(brdf.energy({{kFootprint, view, 0.25}})[0].single, quadrature, 5e-3) << angle;
    EXPECT_NEAR(kept / draws, densities, 4.5 * 0.5 / std::sqrt(draws)) << angle;
    EXPECT_LT(error, 3e-3) << "too noisy to tell";
  }
}

}  // namespace
}  // namespace mica::host::normal_map_brdf_test
