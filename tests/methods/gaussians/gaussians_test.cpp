// `gaussians` against its plain sum in double precision, against the surface that it stands for, and against
// closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "host/base/constants.h"
#include "host/base/error_norms.h"
#include "host/methods/gaussians/mixture_evaluator.h"
#include "host/reference/gaussian_mixture.h"
#include "host/surface/texel_footprint.h"
#include "mica/error.h"
#include "tests/methods/bilinear_samples.h"
#include "tests/methods/gaussians/mixture_culling.h"
#include "tests/methods/gaussians/mixture_surfaces.h"

namespace mica::host::gaussians_test {
namespace {

Device& device() {
  static Device shared(0);  // programs are built once for all tests
  return shared;
}

/// Culling that leaves single precision as the largest error.
constexpr double kFineCutoff = 1e-6;

GaussianEvaluator gaussians(const Surface& surface, int elements,
                            double cutoff_error = MixtureSettings().cutoff_error) {
  MixtureSettings settings;
  settings.elements = elements;
  settings.cutoff_error = cutoff_error;
  return GaussianEvaluator(device(), surface, settings);
}

/// Single precision and culling may cost 1e-4 of the value and 2e-5 of the footprint's brightest.
void expect_plain_sum(const Surface& surface, int elements) {
  GaussianEvaluator evaluator = gaussians(surface, elements, kFineCutoff);
  const reference::GaussianMixture mixture(surface, elements);
  double worst = 0;
  for (const double roughness : {1e-3, 5e-3, 0.03, 0.3}) {
    for (const std::vector<Query>& queries :
         mixture_probes(surface, roughness, 64.0 / (elements * elements))) {
      const std::vector<float> densities = evaluator.evaluate(queries);
      const std::vector<double> expected = mixture.evaluate(queries);
      const double peak = *std::max_element(expected.begin(), expected.end());
      for (std::size_t n = 0; n < queries.size(); ++n) {
        const double allowed = 1e-4 * expected[n] + 2e-5 * peak;
        worst = std::max(worst, std::abs(densities[n] - expected[n]) / allowed);
        EXPECT_NEAR(densities[n], expected[n], allowed)
            << "roughness " << roughness << ", half vector " << queries[n].half_vector.transpose()
            << ", covariance " << queries[n].footprint.cov_uv.reshaped().transpose();
      }
    }
  }
  std::printf("%d elements: worst error %.3f of what is allowed\n", elements, worst);
}

TEST(Gaussians, AreThePlainSumOnNoise) {
  for (const int elements : {1, 2, 4}) expect_plain_sum(mixture_spectrum(), elements);
}
TEST(Gaussians, AreThePlainSumOnBrushedMetal) {
  expect_plain_sum(mixture_brushed(), 1);
}
TEST(Gaussians, AreThePlainSumOnFlakes) {
  expect_plain_sum(mixture_flakes(Interpolation::nearest), 1);
  expect_plain_sum(mixture_flakes(Interpolation::bilinear), 1);
}

/// Relative L2 over half vectors under a footprint of 4 texels, against dense samples of the bilinear
/// patches.
double error_of(const Surface& surface, int elements, double roughness) {
  const Footprint footprint = make_footprint(surface, {0.37, 0.61}, 4, 4, 0);
  const std::vector<Query> queries = lattice_queries(surface, footprint, roughness);
  const std::vector<double> expected = sample_bilinear(surface, queries);
  return relative_l2(gaussians(surface, elements).evaluate(queries), expected);
}

TEST(Gaussians, CullingDropsWhatItMay) {
  for (const Surface& surface : {mixture_spectrum(), mixture_brushed()}) {
    GaussianEvaluator evaluator = gaussians(surface, 1), fine = gaussians(surface, 1, 1e-9);
    expect_culling_drops_little(surface, &evaluator, &fine);
  }
}

/// The errors that were published for these elements, at the same spacing and settings: no worse.
TEST(Gaussians, AreAsCloseToTheMapAsPublished) {
  struct Setting {
    int elements;
    double roughness, noise, brushed;
  };
  for (const Setting& setting :
       {Setting{1, 0.02, 0.07, 0.13}, Setting{1, 0.005, 0.22, 0.28}, Setting{2, 0.02, 0.005, 0.011},
        Setting{2, 0.005, 0.018, 0.027}, Setting{4, 0.005, 0.018, 0.027}}) {
    const double noise = error_of(mixture_spectrum(), setting.elements, setting.roughness);
    const double metal = error_of(mixture_brushed(), setting.elements, setting.roughness);
    std::printf("%d elements, roughness %g: %.2f%% on noise, %.2f%% on brushed metal\n", setting.elements,
                setting.roughness, 100 * noise, 100 * metal);
    EXPECT_LE(noise, setting.noise);
    EXPECT_LE(metal, setting.brushed);
  }
}

/// The published position kernels sum to 0.89 to 1.12, by where a small footprint lies between them.
TEST(Gaussians, IntegrateToOneWhereverTheFootprintLies) {
  constexpr double roughness = 0.02;
  constexpr int side = 150;  // grid points across [-1, 1]: finer than the roughness
  for (const Surface& surface : {mixture_spectrum(), mixture_flakes(Interpolation::nearest)}) {
    GaussianEvaluator evaluator = gaussians(surface, 1);
    for (const double sigma_texels : {0.25, 0.5, 3.0}) {
      for (const double place : {0.0, 0.5}) {  // between texels, on them
        const Eigen::Vector2d mean_uv(place / surface.width() + 0.25, place / surface.height() + 0.5);
        std::vector<Query> queries(side * side,
                                   Query{make_footprint(surface, mean_uv, sigma_texels, sigma_texels, 0),
                                         Eigen::Vector2d::Zero(), roughness});
        for (int n = 0; n < side * side; ++n)
          queries[n].half_vector = {(2.0 * (n % side) + 1) / side - 1, (2.0 * (n / side) + 1) / side - 1};
        const std::vector<float> densities = evaluator.evaluate(queries);
        const double integral = std::accumulate(densities.begin(), densities.end(), 0.0) * 4 / (side * side);
        EXPECT_NEAR(integral, 1, 1e-3) << "footprint " << sigma_texels << ", mean " << mean_uv.transpose();
        EXPECT_GE(*std::min_element(densities.begin(), densities.end()), 0);
      }
    }
  }
}

/// No lobe lies between two flakes: half way between their normals there is nothing.
TEST(Gaussians, KeepFlakesApart) {
  std::vector<Eigen::Vector2d> normals(64 * 64);
  for (int n = 0; n < 64 * 64; ++n) normals[n] = {n % 64 < 32 ? -0.2 : 0.2, 0.0};
  const Surface surface(64, 64, Interpolation::nearest, normals);
  GaussianEvaluator evaluator = gaussians(surface, 1);
  const Footprint footprint = make_footprint(surface, {0.5, 0.5}, 2, 2, 0);
  const auto density = [&](double s) { return evaluator.evaluate({Query{footprint, {s, 0.0}, 0.02}})[0]; };
  const double half_peak = 0.5 / (2 * kPi * 0.02 * 0.02);
  EXPECT_NEAR(density(-0.2) / half_peak, 1, 1e-3);
  EXPECT_NEAR(density(0.2) / half_peak, 1, 1e-3);
  EXPECT_LT(density(0), 1e-9 * half_peak);
}

TEST(Gaussians, RefuseWhatTheyDoNotTake) {
  EXPECT_THROW(gaussians(mixture_spectrum(), 0), UsageError);
  EXPECT_THROW(gaussians(mixture_spectrum(), 5), UsageError);
  EXPECT_THROW(gaussians(mixture_flakes(Interpolation::bicubic), 1), UsageError);
}

}  // namespace
}  // namespace mica::host::gaussians_test
