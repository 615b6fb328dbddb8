// Every hard case on every evaluator: within its bound, refused with a reason, or a limitation that is known.
#include <gtest/gtest.h>

#include <cctype>
#include <cstdio>
#include <limits>

#include "host/methods/ready_densities.h"
#include "host/methods/registry.h"
#include "host/verify/hard_directions.h"
#include "host/verify/judge.h"
#include "host/verify/run_hard_case.h"

namespace mica::host::hard_cases_test {
namespace {

Device& device() {
  static Device shared(0);  // programs are built once for all tests
  return shared;
}

#ifdef __SANITIZE_ADDRESS__  // more of the same questions show the host nothing new
constexpr int kFootprints = 1, kEvaluations = 500, kDirections = 10;
#else
constexpr int kFootprints = 3, kEvaluations = 5000, kDirections = 60;
#endif

class HardCases : public testing::TestWithParam<std::size_t> {};

TEST_P(HardCases, AreAnsweredOrRefusedByEveryEvaluator) {
  const HardCase& hard_case = hard_cases()[GetParam()];
  HardEffort effort;
  effort.footprints = kFootprints, effort.evaluations = kEvaluations;
  const std::vector<HardResult> results = run_hard_case(hard_case, device(), effort);
  // `triangles` refuses nothing that has an answer on a footprint with an area.
  const bool degenerate =
      hard_case.name == "denormal covariances" || hard_case.name == "degenerate covariances";
  const Outcome of_triangles =
      hard_case.must_be_refused || degenerate ? Outcome::refused : Outcome::within_bound;
  std::size_t maps = 0;
  for (const HardResult& result : results) {
    std::printf("%-32s %-10s %-12s %6.3f of %llu compared, %llu looked at  %s\n", result.hard_case.c_str(),
                result.evaluator.c_str(), name_of(result.outcome), result.worst,
                static_cast<unsigned long long>(result.compared),
                static_cast<unsigned long long>(result.evaluated), result.reason.c_str());
    EXPECT_NE(result.outcome, Outcome::broken)
        << hard_case.name << ", " << result.evaluator << ": " << result.reason;
    EXPECT_EQ(result.reason.empty(), result.outcome == Outcome::within_bound) << result.evaluator;
    EXPECT_EQ(result.outcome == Outcome::refused, result.compared == 0) << result.evaluator;
    EXPECT_TRUE(result.outcome == Outcome::refused || !hard_case.must_be_refused) << result.evaluator;
    EXPECT_TRUE(result.outcome == of_triangles || result.evaluator != "triangles") << result.reason;
    maps += result.evaluator != "grid";
  }
  const auto on_maps = [](const MethodTraits& traits) { return traits.compared && traits.map; };
  EXPECT_EQ(maps, MethodRegistry::builtin().names(on_maps).size());
}

INSTANTIATE_TEST_SUITE_P(All, HardCases, testing::Range(std::size_t{0}, hard_cases().size()),
                         [](const auto& info) {
                           std::string name = hard_cases()[info.param].name;
                           for (char& letter : name)
                             if (!std::isalnum(static_cast<unsigned char>(letter))) letter = '_';
                           return name;
                         });

/// Grazing and backfacing directions, on every BRDF.
TEST(HardDirections, AreAnsweredByEveryBrdf) {
  for (const HardDirections& directions : hard_directions()) {
    int answered = 0;
    for (const HardResult& result : run_hard_directions(directions, device(), kDirections)) {
      std::printf("%-36s %-20s %-12s %llu looked at  %s\n", result.hard_case.c_str(),
                  result.evaluator.c_str(), name_of(result.outcome),
                  static_cast<unsigned long long>(result.evaluated), result.reason.c_str());
      EXPECT_NE(result.outcome, Outcome::broken) << result.hard_case << ": " << result.reason;
      EXPECT_EQ(result.evaluated, result.outcome == Outcome::refused ? 0u : 9u * kDirections);
      answered += result.outcome != Outcome::refused;
    }
    EXPECT_GT(answered, 0) << directions.name;
  }
}

/// A table that cannot fail shows nothing: an evaluator that is wrong by a thousandth, and one that answers
/// NaN, are found out.
class Wrong : public Evaluator {
 public:
  Wrong(Evaluator* right, float factor) : right_(right), factor_(factor) {}
  std::unique_ptr<PendingDensities> start(const std::vector<Query>& queries) override {
    std::vector<float> densities = right_->evaluate(queries);
    for (float& density : densities) density *= factor_;
    return std::make_unique<ReadyDensities>(std::move(densities));
  }
  std::string name() const override { return "wrong"; }
  std::size_t device_bytes() const override { return 0; }
  double build_seconds() const override { return 0; }
  double device_seconds() const override { return 0; }

 private:
  Evaluator* right_;
  float factor_;
};

TEST(HardCasesFindOut, WhatIsWrong) {
  const HardCase& hard_case = hard_cases()[7];
  const Surface surface = hard_case.surface();
  const std::unique_ptr<Evaluator> triangles = make_evaluator("triangles", device(), surface);
  const reference::Oracle oracle(surface, 1e-7);
  const MethodRegistry methods = MethodRegistry::builtin();
  const Method& method = methods.get("triangles");
  const auto outcome = [&](float factor) {
    Wrong wrong(triangles.get(), factor);
    return run_trial(hard_case, surface, &wrong, *make_judge(method, *method.settings(), surface, oracle), {})
        .outcome;
  };
  EXPECT_EQ(outcome(1), Outcome::within_bound);
  EXPECT_EQ(outcome(1.001f), Outcome::broken);
  EXPECT_EQ(outcome(-1), Outcome::broken);
  EXPECT_EQ(outcome(std::numeric_limits<float>::quiet_NaN()), Outcome::broken);
  EXPECT_EQ(outcome(std::numeric_limits<float>::infinity()), Outcome::broken);
}

}  // namespace
}  // namespace mica::host::hard_cases_test
