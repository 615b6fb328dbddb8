// The BRDF of a patch of Beckmann lobes: its masking against the integral that it stands for, white furnaces,
// its sampler against its density.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "host/base/masking.h"
#include "host/base/random.h"
#include "host/device/device.h"
#include "host/methods/evaluator.h"
#include "host/methods/patch_brdf.h"
#include "host/methods/registry.h"
#include "host/reference/beckmann_mixture.h"
#include "host/surface/texel_footprint.h"
#include "mica/error.h"
#include "tests/methods/gaussians/mixture_surfaces.h"
#include "tests/statistics/chi_square.h"

namespace mica::host::patch_brdf_test {
namespace {

using reference::BeckmannMixture;

Device& device() {
  static Device shared(0);  // programs are built once for all tests
  return shared;
}

std::unique_ptr<PatchBrdf> beckmanns(const Surface& surface, Masking masking) {
  return make_patch_brdf("beckmanns", device(), surface, {{"masking", std::string(word_of(masking))}});
}

Surface rough(double rms_slope, int resolution = 64, double correlation = 6) {
  return make_surface(
      {"test", SpectrumSurface{resolution, rms_slope, correlation, 3}, Interpolation::bilinear}, nullptr);
}

Eigen::Vector3d direction(double degrees, double azimuth) {
  const double polar = degrees * M_PI / 180;
  return {std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), std::cos(polar)};
}

/// Footprint of the whole map: its mean slope is none.
Footprint whole_map() {
  return {{0.5, 0.5}, Eigen::Matrix2d::Identity()};
}

/// A(i) / (I(o) I(i)), of what a BRDF answers: D of its pdf, and f A(i) = D A(i) / (4 I(o) I(i)).
double areas_of(const BrdfQuery& query, const BrdfValue& value) {
  const Eigen::Vector3d half = (query.view + query.light).normalized();
  const double density = value.pdf * 4 * query.view.dot(half) / half.z();
  return 4 * value.single / density;
}

/// The BRDF's areas are those of [Che18] Eq. 11, which tests/reference integrates numerically, within 1e-3:
/// 16-bit slopes, the pyramid's ripple and its cutoff.
TEST(PatchBrdf, ExactMaskingIsTheIntegralOverTheLobes) {
  double worst = 0;
  for (const double rms_slope : {0.3, 1.0}) {
    const Surface surface = rough(rms_slope);
    const auto brdf = beckmanns(surface, Masking::exact);
    const BeckmannMixture mixture(surface, 1);
    for (const double sigma_texels : {0.3, 1.5, 5.0, 12.0}) {
      const Footprint footprint = make_footprint(surface, {0.3, 0.6}, sigma_texels, 0.6 * sigma_texels, 0.5);
      const std::vector<reference::SlopeLobe> lobes = mixture.lobes(footprint, 0.05);
      for (const double degrees : {0.0, 20.0, 40.0, 60.0, 75.0, 85.0}) {
        for (const double azimuth : {0.4, 2.9}) {
          // A light that some normal mirrors, so that D does not vanish.
          const Eigen::Vector3d view = direction(degrees, azimuth);
          const Eigen::Vector2d slope = lobes[lobes.size() / 2].mean;
          const Eigen::Vector3d normal = Eigen::Vector3d(-slope.x(), -slope.y(), 1).normalized();
          const Eigen::Vector3d light = 2 * view.dot(normal) * normal - view;
          const double received = BeckmannMixture::projected_area(lobes, light);
          if (view.dot(normal) < 0.02 || light.z() < 0.02 || received < 0.02) continue;
          const BrdfQuery query{footprint, view, light, 0.05};
          const double found = areas_of(query, brdf->evaluate({query})[0]);
          const double expected = received / (BeckmannMixture::visible_area(lobes, view) *
                                              BeckmannMixture::visible_area(lobes, light));
          worst = std::max(worst, std::abs(found / expected - 1));
          EXPECT_NEAR(found / expected, 1, 1e-3) << "footprint " << sigma_texels << ", slope " << rms_slope
                                                 << ", view at " << degrees << ", areas " << expected;
        }
      }
    }
  }
  std::printf("areas are off by %.1e at most\n", worst);
}

/// What a white patch scatters to a view: the integral over all lights.
double scattered(PatchBrdf* brdf, const Footprint& footprint, const Eigen::Vector3d& view, double roughness) {
  constexpr int rings = 60, sectors = 80;
  std::vector<BrdfQuery> queries;
  std::vector<double> areas;
  for (int y = 0; y < rings; ++y) {
    const double low = 0.5 * M_PI * y / rings, high = 0.5 * M_PI * (y + 1) / rings,
                 polar = 0.5 * (low + high);
    for (int x = 0; x < sectors; ++x) {
      queries.push_back(
          {footprint, view, direction(polar * 180 / M_PI, 2 * M_PI * (x + 0.5) / sectors), roughness});
      areas.push_back((std::cos(low) - std::cos(high)) * 2 * M_PI / sectors);
    }
  }
  const std::vector<BrdfValue> values = brdf->evaluate(queries);
  double sum = 0;
  for (std::size_t n = 0; n < values.size(); ++n) sum += values[n].single * areas[n];
  return sum;
}

/// [Che18] Fig. 3. 1 - G1(i) is what is lost. Footprints see the whole map.
TEST(PatchBrdf, WhiteFurnaceLosesAndNeverGains) {
  constexpr double roughness = 0.08;
  for (const double rms_slope : {0.3, 1.0}) {
    const Surface surface = rough(rms_slope, 16, 3);
    const auto exact = beckmanns(surface, Masking::exact), filtered = beckmanns(surface, Masking::filtered);
    for (const double degrees : {0.0, 30.0, 60.0, 75.0, 85.0}) {
      const Eigen::Vector3d view = direction(degrees, 0.7);
      const double energy = scattered(exact.get(), whole_map(), view, roughness);
      const double approximate = scattered(filtered.get(), whole_map(), view, roughness);
      std::printf("slope %g, view at %g degrees: %.4f exact, %.4f filtered\n", rms_slope, degrees, energy,
                  approximate);
      EXPECT_LE(energy, 1 + 1e-3);
      EXPECT_GT(energy, 0.4);
      if (degrees <= 75) {
        EXPECT_NEAR(approximate, energy, 0.05);
      }
      const Albedo albedo = exact->energy({{whole_map(), view, roughness}})[0];
      EXPECT_NEAR(albedo.single, energy, 0.01);
      EXPECT_NEAR(albedo.single + albedo.lost, 1, 1e-3);
    }
  }
}

/// [Che18] Fig. 3, right: one roughness for the map and cosines to the geometric normal create energy where a
/// patch is tilted towards the view, more than a tenth.
TEST(PatchBrdf, GeometricMaskingGainsEnergy) {
  const Surface surface = rough(1.0);
  const auto geometric = beckmanns(surface, Masking::geometric);
  double most = 0, least = INFINITY;
  for (int n = 0; n < 24; ++n) {
    const Eigen::Vector2d uv(random_unit(1, 0, n), random_unit(1, 1, n));
    const ViewQuery query{make_footprint(surface, uv, 2, 2, 0), direction(60, 0.7), 0.05};
    const double energy = geometric->energy({query})[0].single;
    most = std::max(most, energy), least = std::min(least, energy);
  }
  std::printf("geometric masking scatters %.3f to %.3f of the light\n", least, most);
  EXPECT_GT(most, 1.1);
}

/// Samples of one view and footprint, which no masking changes, against the density that `evaluate` gives
/// them.
statistics::ChiSquare test_sampler(PatchBrdf* brdf, const ViewQuery& from, const ViewQuery& drawn_from,
                                   std::size_t count) {
  const statistics::SphereBins bins(80, 160);
  const auto density = [&](const std::vector<Eigen::Vector3d>& directions) {
    std::vector<BrdfQuery> queries;
    for (const Eigen::Vector3d& light : directions)
      queries.push_back({from.footprint, from.view, light, from.roughness});
    const std::vector<BrdfValue> values = brdf->evaluate(queries);
    std::vector<double> densities;
    for (const BrdfValue& value : values) densities.push_back(value.pdf);
    return densities;
  };
  const std::vector<double> integrals = bins.integrate(density, 4);
  std::vector<SampleQuery> queries(count, {drawn_from, 0});
  for (std::size_t n = 0; n < count; ++n) queries[n].key = random_bits(7, 0, n);
  std::vector<Eigen::Vector3d> samples;
  for (const BrdfSample& sample : brdf->sample(queries))
    if (sample.pdf > 0) samples.push_back(sample.light.cast<double>());
  return statistics::chi_square_of_directions(bins, samples, count, integrals);
}

std::vector<ViewQuery> sampled_views(const Surface& surface) {
  std::vector<ViewQuery> views;
  for (const Footprint& footprint :
       {make_footprint(surface, {0.31, 0.62}, 0.4, 0.4, 0), make_footprint(surface, {0.8, 0.1}, 3, 0.7, 0.6),
        make_footprint(surface, {0.5, 0.5}, 2.5, 2, 2)})
    for (const double degrees : {0.0, 20.0, 45.0, 65.0, 80.0})
      views.push_back({footprint, direction(degrees, 0.1 + degrees), 0.1});
  return views;
}

TEST(PatchBrdf, SamplesFollowTheirDensity) {
  const Surface surface = mixture_spectrum(0.3);
  const auto brdf = beckmanns(surface, Masking::geometric);
  const std::vector<ViewQuery> views = sampled_views(surface);
  double least = 1;
  for (const ViewQuery& view : views) {
    const statistics::ChiSquare result = test_sampler(brdf.get(), view, view, 1000000);
    least = std::min(least, result.p_value);
    EXPECT_GT(result.p_value, statistics::sidak(0.01, static_cast<int>(views.size())))
        << "view " << view.view.transpose() << ": " << result.statistic << " for "
        << result.degrees_of_freedom;
  }
  std::printf("least p-value of %zu: %.3f\n", views.size(), least);
}

/// The chi-square test rejects samples that are drawn with a roughness 3% too large.
TEST(PatchBrdf, ChiSquareFindsAWrongRoughness) {
  const Surface surface = mixture_spectrum(0.3);
  const auto brdf = beckmanns(surface, Masking::geometric);
  const ViewQuery view = sampled_views(surface)[1];
  ViewQuery wrong = view;
  wrong.roughness *= 1.03;
  EXPECT_LT(test_sampler(brdf.get(), view, wrong, 1000000).p_value, 1e-6);
}

/// Values over pdf, and their mean is what the patch scatters.
TEST(PatchBrdf, WeightsAverageToTheAlbedo) {
  const Surface surface = rough(0.3);
  const auto brdf = beckmanns(surface, Masking::exact);
  const ViewQuery view{make_footprint(surface, {0.4, 0.4}, 3, 2, 1), direction(40, 1), 0.08};
  constexpr int count = 20000;
  std::vector<SampleQuery> queries(count, {view, 0});
  for (int n = 0; n < count; ++n) queries[n].key = random_bits(9, 0, n);
  double sum = 0, squares = 0;
  for (const BrdfSample& sample : brdf->sample(queries)) {
    EXPECT_EQ(sample.weight_multiple, 0);
    sum += sample.weight_single, squares += std::pow(sample.weight_single, 2);
  }
  const double mean = sum / count, error = std::sqrt((squares / count - mean * mean) / count);
  EXPECT_NEAR(mean, scattered(brdf.get(), view.footprint, view.view, view.roughness), 4 * error + 1e-3);
}

TEST(PatchBrdf, AnswersDependOnTheQueryAlone) {
  const Surface surface = mixture_spectrum(0.3);
  for (const Masking masking : {Masking::exact, Masking::filtered, Masking::geometric}) {
    const auto brdf = beckmanns(surface, masking);
    std::vector<BrdfQuery> queries;
    for (int n = 0; n < 300; ++n) {
      const auto random = [&](int stream) { return random_unit(4, stream, n); };
      queries.push_back({make_footprint(surface, {random(0), random(1)}, 0.2 + 20 * random(2) * random(2),
                                        0.2, 3 * random(3)),
                         direction(89 * random(4), 6 * random(5)), direction(89 * random(6), 6 * random(7)),
                         0.03});
    }
    const std::vector<BrdfValue> together = brdf->evaluate(queries);
    for (std::size_t n = 0; n < queries.size(); n += 7) {
      const BrdfValue alone = brdf->evaluate({queries[n]})[0];
      EXPECT_EQ(alone.single, together[n].single);
      EXPECT_EQ(alone.pdf, together[n].pdf);
    }
    for (const BrdfValue& value : together) EXPECT_TRUE(std::isfinite(value.single) && value.single >= 0);
  }
}

TEST(PatchBrdf, NothingIsSeenBelowTheHorizon) {
  const Surface surface = mixture_flakes(Interpolation::nearest);
  const auto brdf = beckmanns(surface, Masking::exact);
  const Footprint footprint = make_footprint(surface, {0.5, 0.5}, 2, 2, 0);
  const Eigen::Vector3d up = direction(20, 1), down = -direction(30, 1), level(1, 0, 0);
  for (const BrdfQuery& query :
       {BrdfQuery{footprint, up, down, 0.1}, BrdfQuery{footprint, down, up, 0.1},
        BrdfQuery{footprint, level, up, 0.1}, BrdfQuery{footprint, down, down, 0.1}}) {
    EXPECT_EQ(brdf->evaluate({query})[0].single, 0);
    EXPECT_EQ(brdf->evaluate({query})[0].pdf, 0);
  }
  EXPECT_EQ(brdf->energy({{footprint, down, 0.1}})[0].single, 0);
  EXPECT_EQ(brdf->sample({{{footprint, down, 0.1}, 1}})[0].pdf, 0);
}

TEST(PatchBrdf, RefusesWhatItDoesNotTake) {
  EXPECT_THROW(make_patch_brdf("triangles", device(), mixture_spectrum()), UsageError);
  EXPECT_THROW(make_patch_brdf("beckmanns", device(), mixture_flakes(Interpolation::bicubic)), UsageError);
}

}  // namespace
}  // namespace mica::host::patch_brdf_test
