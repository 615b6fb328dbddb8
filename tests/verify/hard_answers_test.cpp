// Random questions of every hard kind at once: every method answers all of them, by numbers that are finite
// and not negative.
#include <gtest/gtest.h>

#include <cstdio>
#include <limits>

#include "host/methods/evaluator.h"
#include "host/methods/method.h"
#include "host/methods/ready_densities.h"
#include "host/verify/hard_answers.h"

namespace mica::host::hard_answers_test {
namespace {

#ifdef __SANITIZE_ADDRESS__  // more of the same questions show the host nothing new
constexpr std::uint64_t kAnswers = 500;
#else
constexpr std::uint64_t kAnswers = 4'000;
#endif

TEST(HardAnswers, AreFiniteAndNotNegativeByEveryMethod) {
  Device device(0);
  const std::vector<HardAnswers> all = ask_hard_questions(device, kAnswers);
  std::uint64_t all_answered = 0;
  for (const HardAnswers& answers : all) {
    std::printf("%-16s %llu answered, %llu of them replaced, %llu refused, %llu wrong, %.1f s %s\n",
                answers.method.c_str(), static_cast<unsigned long long>(answers.answered),
                static_cast<unsigned long long>(answers.replaced),
                static_cast<unsigned long long>(answers.refused),
                static_cast<unsigned long long>(answers.wrong), answers.seconds, answers.fault.c_str());
    EXPECT_EQ(answers.wrong, 0u) << answers.method << ": " << answers.fault;
    EXPECT_GE(answers.answered + answers.refused, kAnswers / 200) << answers.method;
    all_answered += answers.answered;
    EXPECT_LE(answers.refused, answers.answered / 100) << answers.method;
    EXPECT_EQ(answers.replaced, 0u) << answers.method;
  }
  EXPECT_GE(all.size(), MethodRegistry::builtin().all().size());
  EXPECT_GE(all_answered, 7 * kAnswers);
}

/// Answers `density` to everything, or fails.
class Constant : public Evaluator {
 public:
  explicit Constant(float density) : density_(density) {}
  std::unique_ptr<PendingDensities> start(const std::vector<Query>& queries) override {
    return std::make_unique<ReadyDensities>(std::vector<float>(queries.size(), density_));
  }
  std::string name() const override { return "constant"; }
  std::size_t device_bytes() const override { return 0; }
  double build_seconds() const override { return 0; }
  double device_seconds() const override { return 0; }

 private:
  float density_;
};

class ConstantMethod : public Method {
 public:
  explicit ConstantMethod(float density) : density_(density) {}
  std::string name() const override { return "constant"; }
  std::string summary() const override { return ""; }
  MethodTraits traits() const override { return {}; }
  StructureSize structure(const StructureAsked&, const MethodSettings&) const override { return {}; }

 protected:
  std::unique_ptr<Evaluator> make_own(Device*, const Surface*, const MethodSettings&) const override {
    return std::make_unique<Constant>(density_);
  }

 private:
  float density_;
};

HardAnswers answers_of(float density) {
  Device device(0);
  MethodRegistry methods;
  methods.add(std::make_shared<ConstantMethod>(density));
  return ask_hard_questions(device, 100, 0, methods).front();
}

TEST(HardAnswers, FindOutWhatIsWrong) {
  EXPECT_EQ(answers_of(1).wrong, 0u);
  EXPECT_EQ(answers_of(-1).answered, 0u);
  EXPECT_GE(answers_of(-1).wrong, 100u);
  EXPECT_GE(answers_of(std::numeric_limits<float>::quiet_NaN()).replaced, 100u);
}

}  // namespace
}  // namespace mica::host::hard_answers_test
