#include "host/measure/measure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "host/measure/point_samples.h"
#include "host/measure/suite.h"
#include "host/methods/registry.h"
#include "host/reference/oracle.h"
#include "host/surface/texel_footprint.h"
#include "mica/error.h"

namespace mica::host::bench::measure_test {
namespace {

TEST(Errors, AreRelativeToTheReferenceAndItsPeak) {
  const Errors errors = errors_of({3, 0, 10.1f}, {4, 0, 10});
  EXPECT_NEAR(errors.relative_l2, std::sqrt((1 + 0.01) / 116), 1e-6);
  EXPECT_NEAR(errors.maximum, 1 / (4 + 0.1), 1e-6);
  EXPECT_NEAR(errors.percentile_99, 0.1 / 10.1, 1e-6);
  EXPECT_EQ(errors_of({4, 0, 10}, {4, 0, 10}).maximum, 0);
}

TEST(Contenders, AreAllOfTheRegistry) {
  const std::vector<Contender> all = contenders(MethodRegistry::builtin(), {1, 2});
  for (const std::string& name : MethodRegistry::builtin().names(
           [](const MethodTraits& traits) { return traits.compared && traits.map; })) {
    const auto count =
        std::count_if(all.begin(), all.end(), [&](const Contender& c) { return c.evaluator == name; });
    const bool mixture = name == "gaussians" || name == "beckmanns";
    EXPECT_EQ(count, mixture ? 2 : name == "triangles" ? 6 : 1) << name;  // precisions of triangles
  }
}

/// In pictures, of precisions only the exact one and that of jobs.
TEST(Contenders, LeaveCurvesOut) {
  std::vector<std::string> knobs;
  for (const Contender& contender : without_curves(contenders(MethodRegistry::builtin(), {1})))
    if (contender.evaluator == "triangles") knobs.push_back(contender.knob);
  EXPECT_EQ(knobs, (std::vector<std::string>{"", "0.01"}));
}

/// The mean of 400 estimates is the density, within four of its standard errors, and the spread is that of
/// samples.
TEST(PointSamples, AreAnUnbiasedEstimate) {
  const Surface surface =
      make_surface({"test", SpectrumSurface{64, 0.15, 8, 3}, Interpolation::bilinear}, nullptr);
  const Query query{make_footprint(surface, {0.4, 0.7}, 3, 1.5, 0.6), surface.texel(25, 44), 0.05};
  const double expected = reference::Oracle(surface).evaluate(query).density;
  for (const std::int64_t samples : {1, 16}) {
    constexpr int estimates = 4000;
    double sum = 0, squares = 0;
    for (const float density : point_samples(surface, std::vector<Query>(estimates, query), samples, 7))
      sum += density, squares += 1.0 * density * density;
    const double mean = sum / estimates, variance = squares / estimates - mean * mean;
    EXPECT_NEAR(mean, expected, 4 * std::sqrt(variance / estimates)) << samples << " samples";
    EXPECT_LT(std::sqrt(variance / estimates), 0.1 * expected);
  }
}

TEST(Suites, HaveNames) {
  Device device(0);
  EXPECT_THROW(run_suite("no such suite", device, [](const std::string&) {}), UsageError);
}

}  // namespace
}  // namespace mica::host::bench::measure_test
