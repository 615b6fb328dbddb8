#include "host/methods/ndf_brdf.h"
#include "host/base/constants.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "host/base/masking.h"
#include "host/base/random.h"
#include "host/device/device.h"
#include "host/methods/evaluator.h"
#include "host/methods/patch_brdf.h"
#include "host/methods/registry.h"

namespace mica::host::ndf_brdf_test {
namespace {

class NdfBrdfTest : public testing::TestWithParam<NdfBrdf::Draws> {
 protected:
  static Surface noise() {
    SpectrumSurface spectrum;
    spectrum.resolution = 64, spectrum.rms_slope = 0.4, spectrum.correlation_texels = 6;
    SurfaceDescription description;
    description.source = spectrum;
    return make_surface(description, nullptr);
  }

  Device device_{0};
  Surface surface_ = noise();
  std::unique_ptr<Evaluator> evaluator_ = make_evaluator("triangles", device_, surface_);
  NdfBrdf brdf_{*evaluator_, surface_, GetParam()};
  ViewQuery from_{{{0.4, 0.7}, Eigen::Matrix2d::Identity() * 5e-4}, {0.6, -0.3, 0}, 0.06};

  void look_at(double z) {
    from_.view = Eigen::Vector3d(0.6, -0.3, 0).normalized() * std::sqrt(1 - z * z) + Eigen::Vector3d(0, 0, z);
  }
  std::vector<BrdfSample> draw(int count) {
    std::vector<SampleQuery> queries;
    for (int n = 0; n < count; ++n)
      queries.push_back({from_, random_bits(3, 1, static_cast<std::uint64_t>(n))});
    return brdf_.sample(queries);
  }
};

TEST_P(NdfBrdfTest, DirectionsAreDrawnWithTheirDensity) {
  constexpr int columns = 16, rows = 8, draws = 60000, part = 16;
  for (const double cos_view : {0.95, 0.2}) {
    look_at(cos_view);
    std::vector<double> counts(columns * rows, 0.0);
    for (const BrdfSample& sample : draw(draws)) {
      if (!(sample.pdf > 0)) continue;
      const double azimuth = std::atan2(sample.light.y(), sample.light.x());
      const int column = std::min(static_cast<int>((azimuth / kPi + 1) / 2 * columns), columns - 1);
      const int row = std::min(static_cast<int>(static_cast<double>(sample.light.z()) * rows), rows - 1);
      ++counts[static_cast<std::size_t>(row * columns + column)];
    }
    std::vector<BrdfQuery> midpoints;
    for (int bin = 0; bin < rows * columns; ++bin)
      for (int k = 0; k < part * part; ++k) {
        const double azimuth = 2 * kPi * (bin % columns + (k % part + 0.5) / part) / columns - kPi;
        const double z = (bin / columns + (k / part + 0.5) / part) / rows, radius = std::sqrt(1 - z * z);
        midpoints.push_back({from_.footprint,
                             from_.view,
                             {radius * std::cos(azimuth), radius * std::sin(azimuth), z},
                             from_.roughness});
      }
    const std::vector<BrdfValue> values = brdf_.evaluate(midpoints);
    double chi_square = 0, freedom = 0;
    for (std::size_t bin = 0; bin < counts.size(); ++bin) {
      double probability = 0;
      for (std::size_t k = 0; k < part * part; ++k) probability += values[bin * part * part + k].pdf;
      const double expected = draws * probability * 2 * kPi / (columns * rows * part * part);
      if (expected < 8) continue;
      chi_square += std::pow(counts[bin] - expected, 2) / expected, ++freedom;
    }
    EXPECT_GT(freedom, 60);
    EXPECT_LT(chi_square, freedom + 5 * std::sqrt(2 * freedom)) << cos_view << ", of " << freedom;
  }
}

TEST_P(NdfBrdfTest, WeightsAreTheValueOverTheDensity) {
  look_at(0.5);
  const std::vector<BrdfSample> drawn = draw(500);
  std::vector<BrdfQuery> queries;
  for (const BrdfSample& sample : drawn)
    queries.push_back(
        {from_.footprint, from_.view, sample.light.cast<double>().stableNormalized(), from_.roughness});
  const std::vector<BrdfValue> values = brdf_.evaluate(queries);
  float largest = 0;
  for (const BrdfValue& value : values) largest = std::max(largest, value.single);
  const float of_peak = 1e-6f * largest;  // what the density promises of its peak
  int drawn_at_all = 0;
  for (std::size_t n = 0; n < drawn.size(); ++n) {
    if (!(drawn[n].pdf > 0)) {
      EXPECT_EQ(drawn[n].weight_single, 0);
      continue;
    }
    ++drawn_at_all;
    EXPECT_NEAR(drawn[n].pdf, values[n].pdf, 1e-3f * values[n].pdf);
    EXPECT_NEAR(drawn[n].weight_single * drawn[n].pdf, values[n].single, 1e-3f * values[n].single + of_peak);
    EXPECT_EQ(drawn[n].weight_multiple, 0);
  }
  EXPECT_GT(drawn_at_all, 350);
}

TEST_P(NdfBrdfTest, NormalsDrawnWithoutTheirDensityWeighAsItDoes) {
  const NormalDraws* normals = brdf_.normal_draws();
  EXPECT_EQ(normals != nullptr, GetParam() == NdfBrdf::Draws::surface_normals);
  if (!normals) return;
  // What a patch reflects of a sky of two halves and a slope, by draws that ask for D and by those that do
  // not.
  const auto sky = [](const Eigen::Vector3d& light) { return (light.x() > 0.1 ? 3 : 1) + light.z(); };
  for (const double cos_view : {0.95, 0.4}) {
    look_at(cos_view);
    constexpr int count = 40000;
    double sums[2] = {0, 0}, squares[2] = {0, 0};
    const auto add = [&](int which, double value) {
      sums[which] += value / count, squares[which] += value * value / count;
    };
    for (const BrdfSample& sample : draw(count))
      add(0, sample.weight_single * sky(sample.light.cast<double>()));
    for (std::uint64_t n = 0; n < count; ++n) {
      const auto uniform = [&](std::uint64_t stream) { return random_unit(5, stream, n); };
      const NormalDraws::Drawn drawn =
          normals->draw_normal(from_, {uniform(0), uniform(1), uniform(2), uniform(3)});
      add(1, drawn.weight * sky(drawn.light));
    }
    const double error = std::sqrt((squares[0] - sums[0] * sums[0] + squares[1] - sums[1] * sums[1]) / count);
    EXPECT_NEAR(sums[1], sums[0], 4.5 * error) << cos_view;
    EXPECT_LT(error, 0.02 * sums[0]) << "too noisy to tell";
  }
}

TEST_P(NdfBrdfTest, HorizonsAreFinite) {
  for (const double z : {1e-7, 1e-5, 1e-3}) {
    look_at(z);
    for (const BrdfSample& sample : draw(400)) {
      EXPECT_TRUE(std::isfinite(sample.pdf) && std::isfinite(sample.weight_single));
      EXPECT_GE(sample.weight_single, 0);
      EXPECT_TRUE(z > 1e-6 || sample.pdf == 0);
    }
    const BrdfQuery below{from_.footprint, from_.view, {0, 0.6, -0.8}, from_.roughness};
    const BrdfQuery opposite{from_.footprint, from_.view, -from_.view, from_.roughness};
    for (const BrdfValue& value : brdf_.evaluate({below, opposite})) {
      EXPECT_EQ(value.single, 0);
      EXPECT_EQ(value.pdf, 0);
    }
  }
}

TEST_P(NdfBrdfTest, EnergyIsTheMeanWeight) {
  look_at(0.9);
  double sum = 0;
  constexpr int count = 20000;
  for (const BrdfSample& sample : draw(count)) sum += sample.weight_single;
  const Albedo albedo = brdf_.energy({from_}).front();
  EXPECT_NEAR(albedo.single, sum / count, 0.1);
  EXPECT_NEAR(albedo.lost, std::max(0.0f, 1 - albedo.single), 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Draws, NdfBrdfTest,
                         testing::Values(NdfBrdf::Draws::surface_normals, NdfBrdf::Draws::smooth_lobe));

}  // namespace
}  // namespace mica::host::ndf_brdf_test
