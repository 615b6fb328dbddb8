// One answer that is not finite costs nobody else's: it is the oracle's, the definition's, or 0.
#include "host/methods/finite_evaluator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "host/methods/finite_brdf.h"
#include "host/methods/grid/grid_evaluator.h"
#include "host/methods/map/image_window.h"
#include "host/methods/ready_densities.h"
#include "host/reference/glint_grid.h"
#include "host/reference/oracle.h"
#include "host/surface/surface.h"
#include "host/surface/texel_footprint.h"
#include "mica/error.h"

namespace mica::host::finite_evaluator_test {
namespace {

constexpr float kGood = 3.25f;

/// Answers every third query with what is no number.
class Failing : public Evaluator {
 public:
  std::unique_ptr<PendingDensities> start(const std::vector<Query>& queries) override {
    std::vector<float> answers(queries.size(), kGood);
    for (std::size_t n = 0; n < answers.size(); n += 3)
      answers[n] = n % 2 ? std::numeric_limits<float>::infinity() : std::numeric_limits<float>::quiet_NaN();
    return std::make_unique<ReadyDensities>(std::move(answers));
  }
  std::unique_ptr<Painter> painter(std::size_t, const QuerySource&, const ImageWindow&) override {
    class Nothing : public Painter {
      std::vector<float> paint(const std::vector<Query>& footprints, const ImageWindow& window) override {
        return std::vector<float>(footprints.size() * window.count(), std::nanf(""));
      }
    };
    return std::make_unique<Nothing>();
  }
  std::string name() const override { return "failing"; }
  std::size_t device_bytes() const override { return 0; }
  double build_seconds() const override { return 0; }
  double device_seconds() const override { return 0; }
};

Surface bumps() {
  return make_surface({"bumps", SpectrumSurface{32, 0.2, 4, 1}, Interpolation::bilinear}, nullptr);
}

std::vector<Query> queries_on(const Surface& surface) {
  std::vector<Query> queries;
  for (int n = 0; n < 8; ++n)
    queries.push_back({make_footprint(surface, {0.11 * n, 0.3}, 2, 1, 0.5), {0.02 * n, -0.03}, 0.05});
  return queries;
}

TEST(FiniteEvaluator, AsksTheOracleForWhatIsNotFinite) {
  const Surface surface = bumps();
  const std::vector<Query> queries = queries_on(surface);
  const auto evaluator = with_finite_answers(std::make_unique<Failing>(), &surface);
  const std::vector<float> answers = evaluator->evaluate(queries);
  for (std::size_t n = 0; n < queries.size(); ++n) {
    const double expected = n % 3 == 0 ? reference::evaluate(surface, queries[n]).density : kGood;
    EXPECT_NEAR(answers[n], expected, 1e-6 * expected) << n;
  }
  EXPECT_EQ(evaluator->replaced(), 3u);
}

TEST(FiniteEvaluator, RepairsPicturesToo) {
  const Surface surface = bumps();
  const std::vector<Query> queries = {queries_on(surface)[2]};
  const auto evaluator = with_finite_answers(std::make_unique<Failing>(), &surface);
  ImageWindow window;
  window.pixels = 3;
  window.radius = 0.3;
  const std::vector<float> image = evaluator->painter(1, nullptr, window)->paint(queries, window);
  ASSERT_EQ(image.size(), 9u);
  for (std::size_t n = 0; n < image.size(); ++n) {
    Query query = queries[0];
    query.half_vector = window.half_vector(n);
    const double expected = reference::evaluate(surface, query).density;
    EXPECT_NEAR(image[n], expected, 1e-6 * expected) << n;
  }
  EXPECT_EQ(evaluator->replaced(), 9u);
}

TEST(FiniteEvaluator, RefusesWhereNoOracleKnowsBetter) {
  const auto evaluator = with_finite_answers(std::make_unique<Failing>(), nullptr);
  EXPECT_THROW(evaluator->evaluate(queries_on(bumps())), DeviceError);
}

/// Glints that differ from query to query, of two colours; each has numbers of its own.
TEST(FiniteEvaluator, GlintsOfAGridAreThoseOfItsDefinition) {
  const std::vector<Query> queries = queries_on(bumps());
  std::vector<GlintPoint> points(queries.size());
  for (std::size_t n = 0; n < points.size(); ++n) points[n].density = 1000.0f * static_cast<float>(n + 1);
  std::vector<std::vector<float>> rows(2, std::vector<float>(queries.size(), kGood));
  rows[1][2] = std::nanf(""), rows[0][5] = rows[1][5] = std::numeric_limits<float>::infinity();
  EXPECT_EQ(replace_what_is_not_finite(queries, points, &rows), 2u);
  for (std::size_t n = 0; n < queries.size(); ++n) {
    const std::vector<double> exact =
        reference::GlintProcess(points[n]).densities_of(queries[n], static_cast<int>(rows.size()));
    for (std::size_t color = 0; color < rows.size(); ++color)
      EXPECT_EQ(rows[color][n], n == 2 || n == 5 ? static_cast<float>(exact[color]) : kGood) << n;
  }
}

/// Every number of an answer in turn is none.
class FailingBrdf : public PatchBrdf {
 public:
  std::vector<BrdfValue> evaluate(const std::vector<BrdfQuery>&) override {
    return {{kNone, 0, 0}, {kGood, kGood, kGood}, {0, kNone, 0}, {0, 0, kNone}};
  }
  std::vector<Albedo> energy(const std::vector<ViewQuery>&) override {
    return {{kNone, 0}, {0, kNone}, {kGood, kGood}};
  }
  std::vector<BrdfSample> sample(const std::vector<SampleQuery>&) override {
    const Eigen::Vector3f up(0, 0, 1);
    return {{up, kGood, kGood, kGood},
            {up * kNone, kGood, 0, 0},
            {up, kNone, 0, 0},
            {up, kGood, kNone, 0},
            {up, kGood, 0, kNone}};
  }
  std::string name() const override { return "failing"; }
  std::size_t device_bytes() const override { return 0; }
  double build_seconds() const override { return 0; }
  double device_seconds() const override { return 0; }

 private:
  static constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
};

TEST(FiniteBrdf, IsZeroWhereItIsNotFinite) {
  const auto brdf = with_finite_answers(std::make_unique<FailingBrdf>());
  const std::vector<BrdfValue> values = brdf->evaluate({});
  for (std::size_t n = 0; n < values.size(); ++n) {
    const float expected = n == 1 ? kGood : 0;
    EXPECT_EQ(values[n].single, expected) << n;
    EXPECT_EQ(values[n].multiple, expected) << n;
    EXPECT_EQ(values[n].pdf, expected) << n;
  }
  const std::vector<Albedo> albedos = brdf->energy({});
  for (std::size_t n = 0; n < albedos.size(); ++n) {
    EXPECT_EQ(albedos[n].single, n == 2 ? kGood : 0) << n;
    EXPECT_EQ(albedos[n].lost, n == 2 ? kGood : 0) << n;
  }
  const std::vector<BrdfSample> samples = brdf->sample({});
  for (std::size_t n = 0; n < samples.size(); ++n) {
    EXPECT_EQ(samples[n].pdf, n == 0 ? kGood : 0) << n;
    EXPECT_EQ(samples[n].weight_single, n == 0 ? kGood : 0) << n;
    EXPECT_TRUE(samples[n].light.allFinite()) << n;
  }
  EXPECT_EQ(brdf->replaced(), 3u + 2u + 4u);
}

}  // namespace
}  // namespace mica::host::finite_evaluator_test
