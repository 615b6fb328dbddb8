// The BRDF of glints and its importance sampling: the density against its definition, draws against the
// density, means against the smooth distribution, and noise against that of drawing from the smooth
// distribution.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "host/base/constants.h"
#include "host/base/random.h"
#include "host/methods/grid/grid_brdf.h"
#include "host/reference/glint_draws.h"

namespace mica::host::grid_brdf_test {
namespace {

class Random {
 public:
  explicit Random(std::uint64_t seed) : seed_(seed) {}
  double operator()() { return random_unit(seed_, 0, counter_++); }
  Eigen::Vector2d in_disk(double radius) {
    const double r = radius * std::sqrt((*this)()), turn = 2 * kPi * (*this)();
    return Eigen::Vector2d(0.5 + 0.5 * r * std::cos(turn), 0.5 + 0.5 * r * std::sin(turn));
  }

 private:
  std::uint64_t seed_, counter_ = 0;
};

GlintsDescription glints_of(Distribution distribution, double alpha, double density) {
  GlintsDescription glints;
  glints.distribution = distribution;
  glints.alpha.setConstant(alpha);
  glints.density = density;
  return glints;
}

reference::GlintProcess process_of(const GlintsDescription& glints) {
  GlintPoint point;
  point.distribution = glints.distribution;
  point.alpha_x = static_cast<float>(glints.alpha.x()), point.alpha_y = static_cast<float>(glints.alpha.y());
  point.density = static_cast<float>(glints.density);
  point.stretch = static_cast<float>(glints.stretch);
  point.seed = glints.seed;
  return reference::GlintProcess(point);
}

Eigen::Vector3d unit(const Eigen::Vector2d& half) {
  return {half.x(), half.y(), std::sqrt(1 - half.squaredNorm())};
}

Eigen::Vector3d mirrored(const Eigen::Vector3d& view, const Eigen::Vector3d& half) {
  return (2 * view.dot(half) * half - view).normalized();
}

class GridBrdfTest : public testing::TestWithParam<Distribution> {
 protected:
  Device device_{0};
};

TEST_P(GridBrdfTest, DensityIsItsDefinition) {
  double worst = 0;
  for (const double alpha : {0.15, 0.5}) {
    GlintsDescription glints = glints_of(GetParam(), alpha, 1e6);
    glints.alpha.y() = 0.6 * alpha, glints.stretch = 2;
    const reference::GlintProcess process = process_of(glints);
    Random random(3);
    std::vector<BrdfQuery> queries;
    std::vector<double> expected;
    while (queries.size() < 2000) {
      Query query;
      query.footprint.mean_uv = {random(), random()};
      query.footprint.cov_uv *= std::pow(1e-4 * std::pow(1e3, random()), 2);
      query.half_vector = process.from_disk(random.in_disk(0.99));
      query.roughness = 0.01 * std::pow(10, random());
      const Eigen::Vector3d half = unit(query.half_vector), view(0.3, 0.2, std::sqrt(1 - 0.13));
      const Eigen::Vector3d light = mirrored(view, half);
      if (light.z() < 0.01 || view.dot(half) < 0.01) continue;
      queries.push_back({query.footprint, view, light, query.roughness});
      expected.push_back(reference::glint_draw_density(process, query) * half.z() / (4 * view.dot(half)));
    }
    const std::vector<BrdfValue> values = GridBrdf(device_, glints).evaluate(queries);
    // What is drawn uniformly bounds the density from below, and is what errors of single lobes are held to.
    for (std::size_t n = 0; n < values.size(); ++n)
      worst = std::max(worst, std::abs(values[n].pdf - expected[n]) / expected[n]);
  }
  std::printf("worst relative error of the density: %.2g\n", worst);
  EXPECT_LE(worst, 5e-4);
}

/// Draws and their density in squares of the disk on which glints are uniform: chi-square, with one more bin
/// for draws below the horizon.
TEST_P(GridBrdfTest, DrawsFollowTheirDensity) {
  constexpr int bins = 12, inside = 24, count = 200000;
  const GlintsDescription glints = glints_of(GetParam(), 0.3, 1e6);
  const reference::GlintProcess process = process_of(glints);
  GridBrdf brdf(device_, glints);
  int tests = 0;
  for (const double sigma_cells : {0.02, 0.3, 2.0}) {
    SampleQuery query;
    query.from.footprint.mean_uv = {0.3127, 0.7218};
    query.from.footprint.cov_uv *= sigma_cells * sigma_cells / glints.density;
    query.from.roughness = 0.06;
    query.from.view = Eigen::Vector3d(0.2, 0, std::sqrt(0.96));
    std::vector<SampleQuery> draws(count, query);
    for (int n = 0; n < count; ++n) draws[n].key = static_cast<std::uint64_t>(n) << 20;
    std::vector<double> observed(bins * bins + 1), expected(bins * bins + 1);
    const auto bin_of = [&](double x) { return std::min(static_cast<int>(bins * x), bins - 1); };
    for (const BrdfSample& sample : brdf.sample(draws)) {
      if (sample.pdf == 0) {
        ++observed.back();
        continue;
      }
      const Eigen::Vector3d half = (query.from.view + sample.light.cast<double>()).normalized();
      const Eigen::Vector2d point = process.to_disk(half.head<2>());
      ++observed[bin_of(point.x()) * bins + bin_of(point.y())];
    }
    // At fine points all over the disk: their density over it, where their light is above the horizon.
    std::vector<BrdfQuery> at;
    std::vector<std::pair<int, double>> places;
    const double step = 1.0 / (bins * inside);
    for (int i = 0; i < bins * inside; ++i) {
      for (int j = 0; j < bins * inside; ++j) {
        const Eigen::Vector2d point(step * (i + 0.5), step * (j + 0.5));
        if ((point - Eigen::Vector2d(0.5, 0.5)).norm() >= 0.5) continue;
        const Eigen::Vector2d on_disk = process.from_disk(point);
        const Eigen::Vector3d half = unit(on_disk), light = mirrored(query.from.view, half);
        if (light.z() < 1e-6 || query.from.view.dot(half) <= 0) continue;
        const double jacobian =
            kPi / 4 * process.smooth_density(on_disk);  // how areas change from (s, t) to the disk, Eq. 3
        at.push_back({query.from.footprint, query.from.view, light, query.from.roughness});
        places.emplace_back(bin_of(point.x()) * bins + bin_of(point.y()),
                            step * step / jacobian * 4 * query.from.view.dot(half) / half.z());
      }
    }
    const std::vector<BrdfValue> values = brdf.evaluate(at);
    double sum = 0;
    for (std::size_t n = 0; n < values.size(); ++n) {
      expected[places[n].first] += count * places[n].second * values[n].pdf;
      sum += places[n].second * values[n].pdf;
    }
    expected.back() = count * (1 - sum);
    double chi_square = 0, rest_observed = 0, rest_expected = 0;
    int degrees = -1;
    for (std::size_t n = 0; n < expected.size(); ++n) {
      if (expected[n] < 200) {  // the grid of points is too coarse for what the disk's rim cuts
        rest_observed += observed[n], rest_expected += expected[n];
        continue;
      }
      chi_square += std::pow(observed[n] - expected[n], 2) / expected[n];
      ++degrees;
    }
    if (rest_expected > 100)
      chi_square += std::pow(rest_observed - rest_expected, 2) / rest_expected, ++degrees;
    ASSERT_GT(degrees, 60);
    const double c = 2.0 / (9 * degrees);
    const double deviations = (std::cbrt(chi_square / degrees) - (1 - c)) / std::sqrt(c);
    std::printf("chi-square of draws, footprint %g cells: %.1f of %d, %.2f deviations\n", sigma_cells,
                chi_square, degrees, deviations);
    EXPECT_LE(deviations, 3.4) << sigma_cells;  // by chance in one of 6 tests with probability 2e-3
    ++tests;
  }
  EXPECT_EQ(tests, 3);
}

/// Light that the smooth distribution sends to a view of a white furnace, by quadrature over the disk.
double smooth_albedo(const GlintsDescription& glints, const Eigen::Vector3d& view,
                     double (*masking)(const GlintsDescription&, const Eigen::Vector3d&,
                                       const Eigen::Vector3d&)) {
  const reference::GlintProcess process = process_of(glints);
  constexpr int side = 1000;
  double sum = 0;
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      const Eigen::Vector2d point((i + 0.5) / side, (j + 0.5) / side);
      if ((point - Eigen::Vector2d(0.5, 0.5)).norm() >= 0.5) continue;
      const Eigen::Vector3d half = unit(process.from_disk(point)), light = mirrored(view, half);
      if (view.dot(half) <= 0 || light.z() <= 0) continue;
      // f i.z di = D G / (4 o.z) 4 o.h dh, dh = ds dt / h.z, D ds dt = dx dy / |U|.
      sum += masking(glints, view, light) * view.dot(half) / (view.z() * half.z()) / (kPi / 4);
    }
  }
  return sum / (side * side);
}

/// Height-correlated Smith's G2 of Trowbridge-Reitz in closed form, and of Beckmann by erf.
double smith(const GlintsDescription& glints, const Eigen::Vector3d& o, const Eigen::Vector3d& i) {
  const auto lambda = [&](const Eigen::Vector3d& v) {
    const double a = 1 / (glints.alpha.x() * std::sqrt(1 - v.z() * v.z()) / v.z() + 1e-300);
    if (glints.distribution == Distribution::trowbridge_reitz) return (std::sqrt(1 + 1 / (a * a)) - 1) / 2;
    return (std::erf(a) - 1) / 2 + std::exp(-a * a) / (2 * a * std::sqrt(kPi));
  };
  return 1 / (1 + lambda(o) + lambda(i));
}

double cavity(const GlintsDescription&, const Eigen::Vector3d& o, const Eigen::Vector3d& i) {
  const Eigen::Vector3d h = (o + i).normalized();
  return std::min(1.0, std::min(2 * h.z() * o.z() / o.dot(h), 2 * h.z() * i.z() / i.dot(h)));
}

TEST_P(GridBrdfTest, FurnaceHasTheSmoothAlbedo) {
  for (const auto masking : {GlintsDescription::Masking::smith, GlintsDescription::Masking::cavity}) {
    GlintsDescription glints = glints_of(GetParam(), 0.3, 1e6);
    glints.masking = masking;
    const Eigen::Vector3d view(0.5, 0, std::sqrt(0.75));
    Random random(17);
    std::vector<SampleQuery> draws(1 << 18);
    for (std::size_t n = 0; n < draws.size(); ++n) {
      draws[n].from.view = view, draws[n].from.roughness = 0.02;
      draws[n].from.footprint.mean_uv = {100 * random(), 100 * random()};
      draws[n].from.footprint.cov_uv *= 1e-6;  // one cell
      draws[n].key = n;
    }
    double sum = 0, squares = 0;
    for (const BrdfSample& sample : GridBrdf(device_, glints).sample(draws))
      sum += sample.weight_single, squares += std::pow(sample.weight_single, 2);
    const auto count = static_cast<double>(draws.size());
    const double mean = sum / count, error = std::sqrt((squares / count - mean * mean) / count);
    const double expected =
        smooth_albedo(glints, view, masking == GlintsDescription::Masking::smith ? smith : cavity);
    std::printf("furnace: %.4f +- %.4f, smooth %.4f\n", mean, error, expected);
    EXPECT_LE(error, 0.005);
    EXPECT_NEAR(mean, expected, 0.02);
    ViewQuery wide = draws[0].from;
    wide.footprint.cov_uv *= 1e6;  // a thousand cells: no glint can be told
    EXPECT_NEAR(GridBrdf(device_, glints).energy({wide})[0].single, expected, 0.02);
  }
}

/// Noise of the light from all around: of draws that follow the glints, over draws that follow the smooth
/// distribution.
TEST_P(GridBrdfTest, DrawsHaveLessNoiseThanThoseOfTheSmoothDistribution) {
  const GlintsDescription glints = glints_of(GetParam(), 0.3, 1e6);
  const reference::GlintProcess process = process_of(glints);
  GridBrdf brdf(device_, glints);
  Random random(29);
  constexpr int footprints = 64, count = 2000;
  double ours = 0, smooth = 0;
  for (int f = 0; f < footprints; ++f) {
    SampleQuery query;
    query.from.view = Eigen::Vector3d(0.3, 0, std::sqrt(0.91));
    query.from.roughness = 0.01;
    query.from.footprint.mean_uv = {random(), random()};
    query.from.footprint.cov_uv *= 1e-6;
    std::vector<SampleQuery> draws(count, query);
    for (int n = 0; n < count; ++n) draws[n].key = n;
    double sum = 0, squares = 0;
    for (const BrdfSample& sample : brdf.sample(draws))
      sum += sample.weight_single, squares += std::pow(sample.weight_single, 2);
    ours += squares / count - std::pow(sum / count, 2);

    std::vector<BrdfQuery> lit;
    std::vector<double> densities;  // densities of the smooth draws, over directions of light
    for (int n = 0; n < count; ++n) {
      const Eigen::Vector3d half = unit(process.from_disk(random.in_disk(1)));
      lit.push_back(
          {query.from.footprint, query.from.view, mirrored(query.from.view, half), query.from.roughness});
      densities.push_back(process.smooth_density(half.head<2>()) * half.z() /
                          (4 * query.from.view.dot(half)));
    }
    const std::vector<BrdfValue> values = brdf.evaluate(lit);
    sum = squares = 0;
    for (int n = 0; n < count; ++n) {
      const double weight = values[n].single > 0 ? values[n].single / densities[n] : 0;
      sum += weight, squares += weight * weight;
    }
    smooth += squares / count - std::pow(sum / count, 2);
  }
  const double ratio = std::sqrt(smooth / ours);
  std::printf("noise of smooth draws over ours: %.2f\n", ratio);
  EXPECT_GT(ratio, 2);
}

TEST_P(GridBrdfTest, DependsOnTheQueryAlone) {
  const GlintsDescription glints = glints_of(GetParam(), 0.4, 1e6);
  std::vector<SampleQuery> draws(500);
  for (std::size_t n = 0; n < draws.size(); ++n) {
    draws[n].from.footprint.cov_uv *= 1e-6;
    draws[n].from.view = Eigen::Vector3d(0.6, 0, 0.8);
    draws[n].key = 977 * n;
  }
  const std::vector<BrdfSample> whole = GridBrdf(device_, glints).sample(draws),
                                parts = GridBrdf(device_, glints, 33).sample(draws);
  for (std::size_t n = 0; n < draws.size(); ++n) {
    EXPECT_EQ(whole[n].light, parts[n].light);
    EXPECT_EQ(whole[n].pdf, parts[n].pdf);
    EXPECT_EQ(whole[n].weight_single, parts[n].weight_single);
  }
}

TEST_P(GridBrdfTest, IsDarkBelowTheHorizon) {
  GridBrdf brdf(device_, glints_of(GetParam(), 0.4, 1e6));
  BrdfQuery query;
  query.light = Eigen::Vector3d(0.8, 0, -0.6);
  EXPECT_EQ(brdf.evaluate({query})[0].single, 0);
  EXPECT_EQ(brdf.evaluate({query})[0].pdf, 0);
  SampleQuery draw;
  draw.from.view = Eigen::Vector3d(1, 0, 0);
  EXPECT_EQ(brdf.sample({draw})[0].pdf, 0);
  EXPECT_EQ(brdf.energy({draw.from})[0].single, 0);
}

TEST_P(GridBrdfTest, StaysFiniteOnHardCases) {
  std::vector<SampleQuery> draws;
  for (const double sigma : {0.0, 1e-6, 1.0, 1e6}) {
    for (const double aspect : {0.0, 1e-6, 1.0}) {
      for (const double micro : {1e-4, 1.0}) {
        for (const double cosine : {1.0, 0.5, 1e-3, 1e-5}) {
          for (std::uint64_t key = 0; key < 40; ++key) {
            SampleQuery draw;
            draw.from.footprint.mean_uv = {-1e7 + 5e5 * static_cast<double>(key), 0.3};
            draw.from.footprint.cov_uv << sigma * sigma, 0, 0, sigma * sigma * aspect * aspect;
            draw.from.view = Eigen::Vector3d(std::sqrt(1 - cosine * cosine), 0, cosine);
            draw.from.roughness = micro;
            draw.key = random_bits(1, draws.size(), key);
            draws.push_back(draw);
          }
        }
      }
    }
  }
  std::size_t drawn = 0;
  for (const double alpha : {1e-4, 1.0}) {
    for (const double density : {1.0, 1e12}) {
      for (const double stretch : {1.0 / 64, 64.0}) {
        GlintsDescription glints = glints_of(GetParam(), alpha, density);
        glints.stretch = stretch;
        for (const BrdfSample& sample : GridBrdf(device_, glints).sample(draws)) {
          ASSERT_TRUE(sample.light.allFinite());
          ASSERT_TRUE(std::isfinite(sample.pdf) && sample.pdf >= 0) << sample.pdf;
          ASSERT_TRUE(std::isfinite(sample.weight_single) && sample.weight_single >= 0)
              << sample.weight_single;
          drawn += sample.pdf > 0;
        }
      }
    }
  }
  EXPECT_GT(drawn, draws.size());  // eight times as many were asked for
}

std::string name_of(const testing::TestParamInfo<Distribution>& info) {
  return info.param == Distribution::beckmann ? "Beckmann" : "TrowbridgeReitz";
}
INSTANTIATE_TEST_SUITE_P(Distributions, GridBrdfTest,
                         testing::Values(Distribution::beckmann, Distribution::trowbridge_reitz), name_of);

}  // namespace
}  // namespace mica::host::grid_brdf_test
