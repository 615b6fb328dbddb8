// What varies over a surface of glints: processes that share the light, glints that are left out, colours.
#include <gtest/gtest.h>

#include <cmath>

#include "host/base/constants.h"
#include "host/base/random.h"
#include "host/methods/grid/grid_evaluator.h"
#include "host/reference/glint_grid.h"

namespace mica::host::glint_process_test {
namespace {

/// Queries with footprints of 0.03 to 30 cells of density 1e6, and a point of its own each.
struct Sample {
  std::vector<Query> queries;
  std::vector<GlintPoint> points;
};
Sample sample_of(Distribution distribution, std::size_t count, std::uint64_t seed) {
  std::uint64_t counter = 0;
  const auto random = [&] { return random_unit(seed, 0, counter++); };
  Sample sample{std::vector<Query>(count), std::vector<GlintPoint>(count)};
  for (std::size_t n = 0; n < count; ++n) {
    GlintPoint& point = sample.points[n];
    point.distribution = distribution;
    point.alpha_x = point.alpha_y = static_cast<float>(0.1 + 0.5 * random());
    point.stretch = static_cast<float>(std::pow(8.0, random()));
    point.share = static_cast<float>(n % 4 == 0 ? 1 : 0.02 + 0.98 * random());
    point.kept = static_cast<float>(n % 3 == 0 ? 1 : 0.25 + 0.75 * random());
    point.seed = static_cast<std::uint32_t>(n);
    Query& query = sample.queries[n];
    query.footprint.mean_uv = {10 * random(), 10 * random()};
    query.footprint.cov_uv *= std::pow(3e-5 * std::pow(1e3, random()), 2);
    const double radius = 0.45 * std::sqrt(random()), turn = 2 * kPi * random();
    query.half_vector = reference::GlintProcess(point).from_disk(
        Eigen::Vector2d(0.5 + radius * std::cos(turn), 0.5 + radius * std::sin(turn)));
    query.roughness = 0.01 * std::pow(10, random());
  }
  return sample;
}

class GlintProcess : public testing::TestWithParam<Distribution> {
 protected:
  Device device_{0};
};

TEST_P(GlintProcess, IsItsDefinition) {
  constexpr int colors = 3;
  const Sample sample = sample_of(GetParam(), 6000, 5);
  GlintGrid grid;
  grid.distribution = GetParam();
  GridEvaluator evaluator(device_, grid, {}, 1000, {colors, true});
  const auto pending = evaluator.start_at(sample.queries, sample.points);
  const std::vector<float> densities = pending->wait();
  double worst = 0;
  for (std::size_t n = 0; n < densities.size(); ++n) {
    const reference::GlintProcess process(sample.points[n]);
    const std::vector<double> expected = process.densities_of(sample.queries[n], colors);
    const double smooth = process.smooth_density(sample.queries[n].half_vector);
    double sum = 0;
    for (std::size_t color = 0; color < colors; ++color) {
      const double error = std::abs(pending->density_of_color(color, n) - expected[color]);
      // A kept share of the glints is brighter by its inverse, and so are the errors.
      worst = std::max(worst, error * sample.points[n].kept / (1e-4 * expected[color] + 1e-6 * smooth));
      sum += expected[color];
    }
    ASSERT_NEAR(densities[n], sum, 2e-4 * sum + 1e-5 * smooth);
  }
  EXPECT_LE(worst, 1);
}

/// A process with a share of the light has that share on average, whatever part of its glints is there; and
/// each of three colours a third of it.
TEST_P(GlintProcess, HasItsShareOnAverage) {
  constexpr int colors = 3;
  GlintGrid grid;
  grid.distribution = GetParam();
  GridEvaluator evaluator(device_, grid, {}, 1 << 18, {colors, true});
  for (const auto& [share, kept] : {std::pair(0.3F, 1.0F), std::pair(0.05F, 0.5F), std::pair(1.0F, 0.3F)}) {
    Sample sample = sample_of(GetParam(), 1 << 18, 9);
    for (std::size_t n = 0; n < sample.queries.size(); ++n) {
      sample.points[n].share = share, sample.points[n].kept = kept, sample.points[n].seed = 1;
      sample.points[n].stretch = 1;
      sample.queries[n].footprint.cov_uv.setIdentity();
      sample.queries[n].footprint.cov_uv *= 9e-6;  // three cells
      sample.queries[n].roughness = 0.05;
    }
    const auto pending = evaluator.start_at(sample.queries, sample.points);
    const std::vector<float> densities = pending->wait();
    double sum = 0, squares = 0, of_color[colors] = {};
    for (std::size_t n = 0; n < densities.size(); ++n) {
      const double smooth =
          reference::GlintProcess(sample.points[n]).smooth_density(sample.queries[n].half_vector);
      sum += densities[n] / smooth, squares += std::pow(densities[n] / smooth, 2);
      for (std::size_t color = 0; color < colors; ++color)
        of_color[color] += pending->density_of_color(color, n) / smooth;
    }
    const auto count = static_cast<double>(densities.size());
    const double mean = sum / count, error = std::sqrt((squares / count - mean * mean) / count);
    EXPECT_LE(error, 0.008 * share);
    EXPECT_NEAR(mean, share, 0.03 * share);
    for (const double part : of_color) EXPECT_NEAR(part / count, share / colors, 0.04 * share / colors);
  }
}

std::string name_of(const testing::TestParamInfo<Distribution>& info) {
  return info.param == Distribution::beckmann ? "Beckmann" : "TrowbridgeReitz";
}
INSTANTIATE_TEST_SUITE_P(Distributions, GlintProcess,
                         testing::Values(Distribution::beckmann, Distribution::trowbridge_reitz), name_of);

}  // namespace
}  // namespace mica::host::glint_process_test
