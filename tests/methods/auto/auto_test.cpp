// `auto`: that it keeps its tolerance, says so, and answers the same whatever the batch.
#include "host/base/error_norms.h"
#include "host/methods/auto/auto_evaluator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "host/base/random.h"
#include "host/methods/auto/sampled_error.h"
#include "host/methods/registry.h"
#include "host/reference/oracle.h"
#include "host/surface/texel_footprint.h"
#include "mica/error.h"
#include "tests/methods/bilinear_samples.h"

namespace mica::host::auto_test {
namespace {

Device& device() {
  static Device shared(0);  // programs are built once for all tests
  return shared;
}

Surface spectrum() {
  return make_surface({"test", SpectrumSurface{256, 0.15, 8, 3}, Interpolation::bilinear}, nullptr);
}

/// Footprints of 2, 8 and 32 texels by turns, half vectors near the normals under them.
std::vector<Query> mixed_queries(const Surface& surface, int count, std::uint64_t seed) {
  std::vector<Query> queries(count);
  for (int n = 0; n < count; ++n) {
    const auto random = [&](std::uint64_t stream) { return random_unit(seed, stream, n); };
    const double sigma = 2 << (n % 3 * 2);
    queries[n].footprint = make_footprint(surface, {random(0), random(1)}, sigma, sigma, 0);
    queries[n].half_vector = surface.texel(std::lround(random(0) * 256), std::lround(random(1) * 256)) +
                             0.02 * Eigen::Vector2d(random(2) - random(3), random(4) - random(5));
    queries[n].roughness = 0.02;
  }
  return queries;
}

std::vector<Query> queries_of_8_texels(const Surface& surface, int count) {
  std::vector<Query> queries = mixed_queries(surface, 3 * count, 14);
  for (int n = 0; n < count; ++n) queries[n] = queries[3 * n + 1];
  queries.resize(count);
  return queries;
}

/// The same whose half vector turns by half a lobe over a footprint's standard deviation.
std::vector<Query> turning(std::vector<Query> queries) {
  for (Query& query : queries) {
    const double sigma_uv = std::sqrt(query.footprint.cov_uv(0, 0));
    query.half_vector_turn = 0.5 * query.roughness / sigma_uv * Eigen::Matrix2d::Identity();
  }
  return queries;
}

std::unique_ptr<AutoEvaluator> calibrated(const Surface& surface, double tolerance,
                                          const std::vector<Query>& queries) {
  auto chooser = std::make_unique<AutoEvaluator>(device(), surface, tolerance);
  chooser->calibrate(calibration_sample(
      queries.size(), 40, surface.width(), surface.height(), [&](std::size_t n) { return queries[n]; }, 1e4));
  return chooser;
}

/// Queries that it was not calibrated with keep the tolerance against the oracle, at 95% confidence.
TEST(Auto, KeepsItsToleranceOnQueriesThatItHasNotSeen) {
  const Surface surface = spectrum();
  const std::vector<Query> fresh = mixed_queries(surface, 120, 11);
  std::vector<double> expected;
  for (const reference::OracleResult& result : reference::Oracle(surface, 1e-5).evaluate(fresh))
    expected.push_back(result.density);
  for (const double tolerance : {0.01, 0.001}) {
    const auto chooser = calibrated(surface, tolerance, mixed_queries(surface, 600, 10));
    EXPECT_EQ(chooser->choices().size(), 3u);
    for (const AutoChoice& choice : chooser->choices()) {
      EXPECT_LE(choice.upper_bound, tolerance) << choice.evaluator;
      EXPECT_LE(choice.relative_l2, choice.upper_bound) << choice.evaluator;
    }
    EXPECT_LE(relative_l2(chooser->evaluate(fresh), expected), tolerance);
  }
}

/// Queries with a first order are classes of their own, of which the wide ones are worth a pyramid as well.
TEST(Auto, KeepsItsToleranceOnQueriesThatTurn) {
  const Surface surface = spectrum();
  const auto chooser = calibrated(surface, 0.01, turning(mixed_queries(surface, 300, 10)));
  ASSERT_EQ(chooser->choices().size(), 3u);
  for (const AutoChoice& choice : chooser->choices()) {
    EXPECT_TRUE(choice.kind.first_order);
    EXPECT_LE(choice.upper_bound, 0.01) << choice.evaluator;
  }
  EXPECT_EQ(chooser->choices().back().evaluator.find("pyramid"), 0u) << chooser->choices().back().evaluator;
  const std::vector<Query> fresh = turning(mixed_queries(surface, 60, 11));
  std::vector<double> expected;
  for (const reference::OracleResult& result : reference::Oracle(surface, 1e-5).evaluate(fresh))
    expected.push_back(result.density);
  const double error = relative_l2(chooser->evaluate(fresh), expected);
  EXPECT_LE(error, 0.01);
  EXPECT_GT(error, 1e-4);  // what `triangles` would be off by: it was not they who answered
}

TEST(Auto, TakesThePyramidForLargeFootprintsAndTexelsForSmallOnes) {
  const Surface surface = spectrum();
  const auto chooser = calibrated(surface, 0.01, mixed_queries(surface, 600, 10));
  EXPECT_EQ(chooser->choices().front().evaluator.find("pyramid"), std::string::npos);
  EXPECT_EQ(chooser->choices().back().evaluator.find("pyramid"), 0u) << chooser->choices().back().evaluator;
}

/// Between what few samples of a cheap evaluator show and what they prove, more samples tell, as far as they
/// are affordable.
TEST(Auto, LooksAtMoreSamplesWhereFewCannotTell) {
  const Surface surface = spectrum();
  const std::vector<Query> queries = queries_of_8_texels(surface, 4096);
  const std::vector<Query> few(queries.begin(), queries.begin() + 256);
  const auto choice_of = [&](double tolerance, const std::vector<Query>& sample, double seconds) {
    AutoEvaluator chooser(device(), surface, tolerance, seconds);
    chooser.calibrate({sample});
    return chooser.choices().front();
  };
  const AutoChoice loose = choice_of(0.1, queries, 2);
  ASSERT_EQ(loose.samples, 256u);
  const double tolerance = 0.6 * loose.upper_bound + 0.4 * loose.relative_l2;
  const AutoChoice strict = choice_of(tolerance, few, 2), told = choice_of(tolerance, queries, 2);
  EXPECT_GT(strict.cost, loose.cost);
  EXPECT_NE(strict.evaluator, loose.evaluator);
  EXPECT_EQ(told.evaluator, loose.evaluator);
  EXPECT_EQ(told.samples, 1024u);
  EXPECT_LE(told.upper_bound, tolerance);
  const AutoChoice hasty = choice_of(tolerance, queries, 1e-9);
  EXPECT_EQ(hasty.samples, 16u);  // the fewest
}

/// Where triangles are affordable for a handful of wide footprints only, a precise pyramid tells more.
TEST(Auto, LooksAtManyWideFootprintsByAPrecisePyramid) {
  const Surface surface = spectrum();
  std::vector<Query> queries = mixed_queries(surface, 3 * 1024, 15);
  for (std::size_t n = 0; n < 1024; ++n) queries[n] = queries[3 * n + 2];
  queries.resize(1024);
  AutoEvaluator chooser(device(), surface, 0.01, 1e-9);
  chooser.calibrate({queries});
  const AutoChoice choice = chooser.choices().front();
  EXPECT_EQ(choice.evaluator.substr(0, 7), "pyramid");
  EXPECT_GE(choice.samples, 256u);
  const std::vector<float> expected = make_evaluator("triangles", device(), surface)->evaluate(queries);
  const double error = relative_l2(chooser.evaluate(queries), expected);
  std::printf("%s: %.2f%%, at most %.2f%%\n", choice.evaluator.c_str(), 100 * error,
              100 * choice.upper_bound);
  EXPECT_LE(error, choice.upper_bound);
}

/// The first samples show more than a tolerance that is kept: they cannot tell either.
TEST(Auto, LooksAtMoreSamplesWhereFewShowTooMuch) {
  const Surface surface = spectrum();
  std::vector<Query> queries = queries_of_8_texels(surface, 4096);
  const std::vector<float> expected = make_evaluator("triangles", device(), surface)->evaluate(queries),
                           densities = make_evaluator("gaussians", device(), surface, {{"elements", "1"}})
                                           ->evaluate(queries);
  double largest = 0;
  std::ptrdiff_t worst = 0;
  for (std::ptrdiff_t first = 0; first < 4096; first += 256) {
    const auto part = [first](const std::vector<float>& all) {
      return std::vector<float>(all.begin() + first, all.begin() + first + 256);
    };
    const double error = sampled_error(part(densities), part(expected), 2).relative_l2;
    if (error > largest) largest = error, worst = first;
  }
  std::rotate(queries.begin(), queries.begin() + worst, queries.end());
  const double bound = sampled_error(densities, expected, 2.5).upper_bound + 1e-4;
  ASSERT_LT(bound, largest);
  AutoEvaluator chooser(device(), surface, 0.5 * (bound + largest));
  chooser.calibrate({queries});
  EXPECT_EQ(chooser.choices().front().evaluator, "gaussians, 1 a texel and axis");
  EXPECT_GT(chooser.choices().front().samples, 256u);
}

/// Of half vectors far out in the tails of their lobes triangles are off by more than they promise. Exact
/// ones answer these, unless beside other queries they show next to nothing.
TEST(Auto, LeavesDimQueriesToTrianglesThatAreOff) {
  const Surface surface = spectrum();
  std::vector<Query> dim = queries_of_8_texels(surface, 300);
  double steepest = 0;
  for (const Eigen::Vector2d& normal : surface.normals()) steepest = std::max(steepest, normal.x());
  for (Query& query : dim) query.half_vector = {steepest + 3.5 * query.roughness, 0};
  std::vector<Query> bright = mixed_queries(surface, 900, 10);
  bright.erase(std::remove_if(bright.begin(), bright.end(),
                              [&](const Query& query) {
                                return class_of(query, 256, 256).size == class_of(dim[0], 256, 256).size;
                              }),
               bright.end());
  const auto choice_of_dim = [&](const std::vector<Query>& queries) {
    AutoEvaluator chooser(device(), surface, 0.01);
    chooser.calibrate({queries});
    for (const AutoChoice& choice : chooser.choices())
      if (choice.kind.size == class_of(dim[0], 256, 256).size) return choice;
    return AutoChoice{};
  };
  EXPECT_EQ(choice_of_dim(dim).evaluator, "triangles");
  std::vector<Query> both = dim;
  both.insert(both.end(), bright.begin(), bright.end());
  const AutoChoice among_others = choice_of_dim(both);
  EXPECT_EQ(among_others.evaluator, "triangles, to 0.01");
  EXPECT_GT(among_others.relative_l2, 0.01);
  EXPECT_GE(among_others.upper_bound, among_others.relative_l2);
}

/// A structure that takes longer to build than its queries take without it is not built.
TEST(Auto, BuildsNothingThatFewQueriesCannotRepay) {
  const Surface surface = spectrum();
  const std::vector<Query> queries = mixed_queries(surface, 600, 10);
  const auto choices_for = [&](double queries_of_a_class) {
    AutoEvaluator chooser(device(), surface, 0.01);
    chooser.calibrate(calibration_sample(
        queries.size(), 100, 256, 256, [&](std::size_t n) { return queries[n]; }, queries_of_a_class / 200));
    return chooser.choices();
  };
  for (const AutoChoice& choice : choices_for(1)) {
    EXPECT_EQ(choice.evaluator, "triangles, to 0.01");
    EXPECT_EQ(choice.samples, 0u);  // not even looked at: it promises the tolerance
    EXPECT_EQ(choice.upper_bound, 0.01);
  }
  EXPECT_EQ(choices_for(1e7).back().evaluator.find("pyramid"), 0u);
}

TEST(Auto, AnswersAreTheSameInAnyBatch) {
  const Surface surface = spectrum();
  const std::vector<Query> queries = mixed_queries(surface, 90, 10);
  const auto whole = calibrated(surface, 0.01, queries), parts = calibrated(surface, 0.01, queries);
  const std::vector<float> expected = whole->evaluate(queries);
  for (std::size_t n = 0; n < queries.size(); n += 9) {
    const auto first = queries.begin() + static_cast<long>(n);
    const std::vector<float> some = parts->evaluate({first, first + 9});
    for (std::size_t k = 0; k < some.size(); ++k) EXPECT_EQ(some[k], expected[n + k]);
  }
}

/// Of queries that it has not seen, errors are no larger than estimated, in root mean square; of bright and
/// of dim ones, which the calibration did not tell apart, no more than twice as large.
TEST(Auto, EstimatesTheErrorOfEachQuery) {
  const Surface surface = spectrum();
  const auto chooser = calibrated(surface, 0.01, mixed_queries(surface, 600, 10));
  std::vector<Query> fresh = mixed_queries(surface, 480, 13);
  const std::vector<float> densities = chooser->evaluate(fresh);
  const std::unique_ptr<Evaluator> triangles = make_evaluator("triangles", device(), surface);  // keeps 1e-4
  const std::vector<float> expected = triangles->evaluate(fresh);
  double mean = 0;
  for (const float density : expected) mean += density / static_cast<double>(expected.size());
  double all_errors = 0, all_estimates = 0, all_references = 0;
  for (const bool bright : {false, true}) {
    double errors = 0, estimates = 0;
    for (std::size_t n = 0; n < fresh.size(); ++n) {
      if ((expected[n] > mean) != bright) continue;
      errors += std::pow(densities[n] - expected[n], 2);
      estimates += std::pow(chooser->error_estimate(fresh[n], densities[n]), 2);
      all_references += std::pow(expected[n], 2);
    }
    std::printf("errors %.3g, estimates %.3g\n", std::sqrt(errors), std::sqrt(estimates));
    EXPECT_LE(errors, 4 * estimates) << bright;
    EXPECT_LE(estimates, 16 * errors) << bright;
    all_errors += errors, all_estimates += estimates;
  }
  EXPECT_LE(all_errors, all_estimates);
  EXPECT_LE(all_estimates, 1e-4 * all_references);  // the tolerance
}

/// A class that was not sampled is left to those who promise the tolerance.
TEST(Auto, AnswersWhatItWasNotCalibratedForWithTriangles) {
  const Surface surface = spectrum();
  AutoEvaluator chooser(device(), surface, 0.01);
  chooser.calibrate(CalibrationSample{});
  const std::vector<Query> queries = mixed_queries(surface, 12, 12);
  std::vector<double> expected;
  for (const reference::OracleResult& result : reference::Oracle(surface, 1e-6).evaluate(queries))
    expected.push_back(result.density);
  const double error = relative_l2(chooser.evaluate(queries), expected);
  EXPECT_LE(error, 0.01);
  EXPECT_GT(error, 1e-4);  // they were not asked for more
}

TEST(Auto, RefusesToPromiseTooMuch) {
  const Surface surface = spectrum();
  EXPECT_THROW(AutoEvaluator(device(), surface, 1e-4), UsageError);
  EXPECT_THROW(AutoEvaluator(device(), surface, std::nan("")), UsageError);
}

TEST(Auto, SamplesEveryClass) {
  const Surface surface = spectrum();
  const std::vector<Query> queries = mixed_queries(surface, 300, 10);
  const CalibrationSample sample = calibration_sample(
      queries.size(), 7, 256, 256, [&](std::size_t n) { return queries[n]; }, 2.5);
  EXPECT_EQ(sample.queries.size(), 21u);
  ASSERT_EQ(sample.counts.size(), 3u);
  for (const auto& [kind, count] : sample.counts) EXPECT_DOUBLE_EQ(count, 250) << kind.size;
  std::map<int, int> counts;
  for (const Query& query : sample.queries) ++counts[class_of(query, 256, 256).size];
  for (const auto& [size, count] : counts) EXPECT_EQ(count, 7) << size;
}

}  // namespace
}  // namespace mica::host::auto_test
