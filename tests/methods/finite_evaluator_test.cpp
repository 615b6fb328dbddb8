// One answer that is not finite costs nobody else's, and is the oracle's.
#include "host/methods/finite_evaluator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "host/methods/map/image_window.h"
#include "host/methods/ready_densities.h"
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

}  // namespace
}  // namespace mica::host::finite_evaluator_test
