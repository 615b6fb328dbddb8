// `pyramid` against the oracle, and its structure against what must be conserved.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numeric>

#include "host/base/constants.h"
#include "host/base/error_norms.h"
#include "host/base/random.h"
#include "host/methods/pyramid/pyramid_evaluator.h"
#include "host/methods/triangles/triangle_evaluator.h"
#include "host/reference/oracle.h"
#include "host/surface/texel_footprint.h"
#include "tests/methods/bilinear_samples.h"

namespace mica::host::pyramid_test {
namespace {

Device& device() {
  static Device shared(0);  // programs are built once for all tests
  return shared;
}

Surface spectrum(Interpolation interpolation) {
  return make_surface({"test", SpectrumSurface{256, 0.15, 8, 3}, interpolation}, nullptr);
}
Surface flakes() {
  return make_surface({"test", FlakesSurface{256, 12, 0.2, 5}, Interpolation::nearest}, nullptr);
}
/// Neither side is a multiple of a block.
Surface oblong() {
  constexpr int width = 203, height = 150;
  std::vector<Eigen::Vector2d> normals;
  for (int j = 0; j < height; ++j) {
    for (int i = 0; i < width; ++i) {
      const double x = 2 * kPi * i / width, y = 2 * kPi * j / height;
      normals.emplace_back(0.08 * std::sin(17 * x + std::sin(y)) + 0.06 * std::cos(29 * x - 2 * y),
                           0.05 * std::sin(9 * x + 3 * y));
    }
  }
  return Surface(width, height, Interpolation::bilinear, std::move(normals));
}

/// Footprints of one size anywhere on the map, also outside its first period, each with the normal of a texel
/// under it, blurred by the roughness.
std::vector<Query> random_queries(const Surface& surface, double major_texels, double minor_texels,
                                  double roughness, int count) {
  std::vector<Query> queries(count);
  for (int n = 0; n < count; ++n) {
    const auto random = [&](std::uint64_t stream) { return random_unit(7, stream, n); };
    const Eigen::Vector2d mean_uv(4 * random(0) - 2, 4 * random(1) - 2);
    queries[n].footprint = make_footprint(surface, mean_uv, major_texels, minor_texels, kPi * random(2));
    const long i = std::lround(mean_uv.x() * surface.width() + minor_texels * (2 * random(3) - 1));
    const long j = std::lround(mean_uv.y() * surface.height() + minor_texels * (2 * random(4) - 1));
    const double distance = roughness * std::sqrt(-2 * std::log(1 - random(5))), angle = 2 * kPi * random(6);
    queries[n].half_vector =
        surface.texel(i, j) + distance * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    queries[n].roughness = roughness;
  }
  return queries;
}

double error_of(Evaluator* evaluator, const reference::Oracle& oracle, const std::vector<Query>& queries) {
  std::vector<double> expected;
  for (const reference::OracleResult& result : oracle.evaluate(queries)) expected.push_back(result.density);
  return relative_l2(evaluator->evaluate(queries), expected);
}

/// One percent at any footprint, from those of a few texels to those of many periods.
void expect_one_percent(const Surface& surface, double roughness) {
  PyramidEvaluator pyramid(device(), surface);
  const reference::Oracle oracle(surface, 1e-4);
  for (const double sigma : {3.0, 16.0, 30.0, 5000.0}) {
    const double error = error_of(&pyramid, oracle, random_queries(surface, sigma, sigma, roughness, 40));
    std::printf("roughness %g, footprint %g: %.2f%%\n", roughness, sigma, 100 * error);
    EXPECT_LE(error, 0.01) << "roughness " << roughness << ", footprint " << sigma;
  }
}

TEST(Pyramid, KeepsOnePercentOnNoise) {
  for (const double roughness : {0.005, 0.07})
    expect_one_percent(spectrum(Interpolation::bilinear), roughness);
}
TEST(Pyramid, KeepsOnePercentOnFlakes) {
  for (const double roughness : {0.005, 0.02}) expect_one_percent(flakes(), roughness);
}
/// Half vectors that hardly a flake under their footprints faces: what is seen of these are tails.
TEST(Pyramid, KeepsTheTailsOfFlakes) {
  const Surface surface =
      make_surface({"test", FlakesSurface{512, 12, 0.2, 5}, Interpolation::nearest}, nullptr);
  std::vector<Query> queries = random_queries(surface, 32, 32, 0.005, 128);
  for (std::size_t n = 0; n < queries.size(); ++n)
    queries[n].half_vector = {0.0012 * static_cast<double>(n), 0.05 - 0.0008 * static_cast<double>(n)};
  PyramidEvaluator pyramid(device(), surface);
  const double error = error_of(&pyramid, reference::Oracle(surface, 1e-4), queries);
  std::printf("%.2f%%\n", 100 * error);
  EXPECT_LE(error, 0.005);
}
TEST(Pyramid, KeepsOnePercentOnAMapThatIsNoMultipleOfABlock) {
  expect_one_percent(oblong(), 0.02);
}
TEST(Pyramid, KeepsOnePercentOnABicubicMap) {
  const Surface surface =
      make_surface({"test", SpectrumSurface{64, 0.15, 8, 3}, Interpolation::bicubic}, nullptr);
  expect_one_percent(surface, 0.02);
}

/// Memory in which only compact levels fit.
PyramidSettings compact_settings(const Surface& surface, double roughness) {
  PyramidSettings settings;
  std::size_t bytes = std::size_t{1} << 24;
  const double width = cell_width(cell_class_of(roughness), settings.precision);
  while (!levels_that_fit(surface, width, bytes).compact) bytes -= bytes / 8;
  settings.levels_bytes = bytes;
  return settings;
}

void expect_one_percent_of_compact_levels(const Surface& surface, double roughness) {
  PyramidEvaluator pyramid(device(), surface, compact_settings(surface, roughness));
  const reference::Oracle oracle(surface, 1e-4);
  for (const double sigma : {30.0, 5000.0}) {
    const std::vector<Query> queries = random_queries(surface, sigma, sigma, roughness, 40);
    const std::optional<PyramidChoice> choice = pyramid.choose(queries.front());
    ASSERT_TRUE(choice);
    EXPECT_EQ(pyramid.level(*choice).shape().record_bits, 8);
    const double error = error_of(&pyramid, oracle, queries);
    std::printf("roughness %g, footprint %g, compact: %.2f%%\n", roughness, sigma, 100 * error);
    EXPECT_LE(error, 0.01) << "roughness " << roughness << ", footprint " << sigma;
  }
}

TEST(Pyramid, KeepsOnePercentOfCompactLevels) {
  expect_one_percent_of_compact_levels(spectrum(Interpolation::bilinear), 0.005);
  expect_one_percent_of_compact_levels(spectrum(Interpolation::bilinear), 0.02);
  expect_one_percent_of_compact_levels(oblong(), 0.02);
}

/// Flakes face everywhere: sixteen of a group are too far apart for 8 bits.
TEST(Pyramid, HasNoCompactLevelsOfFewElements) {
  const Surface surface = flakes();
  for (std::size_t bytes = 1 << 24; bytes > 1000; bytes /= 2)
    EXPECT_FALSE(levels_that_fit(surface, 0.0075, bytes).compact) << bytes;
}

/// The level is that of the minor axis.
TEST(Pyramid, KeepsOnePercentOfLongFootprints) {
  const Surface surface = spectrum(Interpolation::bilinear);
  PyramidEvaluator pyramid(device(), surface);
  const reference::Oracle oracle(surface, 1e-4);
  for (const double aspect : {3.0, 15.0}) {
    const std::vector<Query> queries = random_queries(surface, 24 * aspect, 24, 0.02, 20);
    EXPECT_TRUE(pyramid.choose(queries.front()));
    EXPECT_LE(error_of(&pyramid, oracle, queries), 0.01) << "aspect " << aspect;
  }
}

/// Elements are far wider than the roughness here, and their normals follow from where they lie.
TEST(Pyramid, DropsOnlyWhatIsBelowTheCutoff) {
  const Surface surface = oblong();
  const std::vector<Query> queries = random_queries(surface, 24, 24, 0.005, 400);
  const auto evaluate = [&](double cutoff_error) {
    PyramidSettings settings;
    settings.precision = {1.42, 12, cutoff_error};
    PyramidEvaluator pyramid(device(), surface, settings);
    EXPECT_TRUE(pyramid.choose(queries.front()));
    return pyramid.evaluate(queries);
  };
  const std::vector<float> all = evaluate(1e-12);
  const double dropped = relative_l2(evaluate(1e-5), all);
  std::printf("%.2g\n", dropped);
  EXPECT_LE(dropped, 2e-6);
}

/// Normals change by many cells a texel here, so that wide elements share a record with narrow ones: of these
/// the record's numbers must still leave a covariance. Four periods, so that normals meet again and merge.
TEST(Pyramid, AnswersSteepMaps) {
  constexpr int period = 32, side = 2 * period;
  const Surface steep =
      make_surface({"test", SpectrumSurface{period, 5, 2, 1}, Interpolation::bilinear}, nullptr);
  std::vector<Eigen::Vector2d> normals;
  for (int n = 0; n < side * side; ++n) normals.push_back(steep.texel(n % side, n / side));
  const Surface surface(side, side, Interpolation::bilinear, std::move(normals));
  PyramidSettings settings;
  settings.levels_bytes = std::size_t{128} << 20;
  PyramidEvaluator pyramid(device(), surface, settings);
  const std::vector<Query> queries = random_queries(surface, 14, 14, 0.0029, 400);
  ASSERT_TRUE(pyramid.choose(queries.front()));
  for (const float density : pyramid.evaluate(queries)) ASSERT_TRUE(std::isfinite(density));
}

TEST(Pyramid, IntegratesToOne) {
  constexpr double roughness = 0.02;
  constexpr int side = 150;  // grid points across [-1, 1]: finer than the roughness
  const Surface surface = spectrum(Interpolation::bilinear);
  PyramidEvaluator pyramid(device(), surface);
  for (const double sigma : {16.0, 60.0, 190.0, 1e4}) {
    std::vector<Query> queries(side * side, Query{make_footprint(surface, {0.3, 0.8}, sigma, sigma, 0),
                                                  Eigen::Vector2d::Zero(), roughness});
    for (int n = 0; n < side * side; ++n)
      queries[n].half_vector = {(2.0 * (n % side) + 1) / side - 1, (2.0 * (n / side) + 1) / side - 1};
    const std::vector<float> densities = pyramid.evaluate(queries);
    const double integral = std::accumulate(densities.begin(), densities.end(), 0.0) * 4 / (side * side);
    EXPECT_NEAR(integral, 1, 0.005) << "footprint " << sigma;
  }
}

/// Also when another level of the same cells was built first, from other blocks.
TEST(Pyramid, AnswersAreTheSameInAnyBatchAndOrder) {
  const Surface surface = spectrum(Interpolation::bilinear);
  std::vector<Query> queries;
  for (const double sigma : {70.0, 3.0, 16.0, 5000.0, 30.0})
    for (const Query& query : random_queries(surface, sigma, sigma, 0.02, 30)) queries.push_back(query);
  PyramidEvaluator whole(device(), surface);
  const std::vector<float> expected = whole.evaluate(queries);
  PyramidSettings settings;
  settings.batch_queries = 7;
  PyramidEvaluator parts(device(), surface, settings);
  for (std::size_t n = 0; n < queries.size(); n += 10) {
    const auto first = queries.begin() + static_cast<long>(n);
    const std::vector<float> some = parts.evaluate({first, first + 10});
    for (std::size_t k = 0; k < some.size(); ++k) EXPECT_EQ(some[k], expected[n + k]) << "query " << n + k;
  }
}

TEST(Pyramid, SendsSmallFootprintsAndRoughnessesToTheTexels) {
  const Surface surface = spectrum(Interpolation::bilinear);
  PyramidEvaluator pyramid(device(), surface);
  const auto choice = [&](double major, double minor, double roughness) {
    return pyramid.choose({make_footprint(surface, {0.5, 0.5}, major, minor, 0.3), {0, 0}, roughness});
  };
  EXPECT_FALSE(choice(5, 5, 0.02));
  EXPECT_FALSE(choice(40, 40, 1e-4));
  ASSERT_TRUE(choice(40, 40, 0.02));
  EXPECT_LE(choice(40, 40, 0.02)->block, 64);
  EXPECT_TRUE(choice(1e5, 1e4, 0.02)->uniform);
}

/// Normals so far apart that cells hold a texel's each: levels would cost seconds and merge nothing.
TEST(Pyramid, BuildsNothingWhereNothingMerges) {
  const Surface steep =
      make_surface({"test", SpectrumSurface{128, 2, 3, 1}, Interpolation::bilinear}, nullptr);
  PyramidEvaluator pyramid(device(), steep);
  TriangleEvaluator triangles(device(), steep);
  for (const double sigma : {64.0, 5000.0}) {
    const std::vector<Query> queries = random_queries(steep, sigma, sigma, 0.0022, 3);
    EXPECT_FALSE(pyramid.choose(queries[0]));
    EXPECT_EQ(pyramid.evaluate(queries), triangles.evaluate(queries));
  }
  EXPECT_EQ(pyramid.device_bytes(), triangles.device_bytes());
  EXPECT_TRUE(pyramid.choose(random_queries(steep, 64, 64, 0.1, 1)[0]));
}

}  // namespace
}  // namespace mica::host::pyramid_test
