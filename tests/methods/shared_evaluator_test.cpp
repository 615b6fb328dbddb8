// Several devices as one: every answer at its place whoever gave it, and errors that say whose they are.
#include "host/methods/shared_evaluator.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <string>
#include <thread>

#include "host/methods/ready_densities.h"
#include "mica/error.h"

namespace mica::host::shared_evaluator_test {
namespace {

using namespace std::chrono_literals;

/// Where evaluators wait for each other, so that each has a part in a batch.
struct Meeting {
  std::mutex mutex;
  std::condition_variable came;
  std::size_t expected = 0, present = 0;

  bool meet() {
    std::unique_lock<std::mutex> lock(mutex);
    ++present;
    came.notify_all();
    return came.wait_for(lock, 20s, [&] { return present >= expected; });
  }
};

/// Answers a query's roughness, and of color c with c more.
class Echo : public Evaluator {
 public:
  class Pending : public ReadyDensities {
   public:
    explicit Pending(const std::vector<float>& answers) : ReadyDensities(answers), answers_(answers) {}
    float density_of_color(std::size_t color, std::size_t query) const override {
      return answers_[query] + static_cast<float>(color);
    }

   private:
    std::vector<float> answers_;
  };

  Echo(Meeting* meeting, std::string failure = "") : meeting_(meeting), failure_(std::move(failure)) {}

  std::unique_ptr<PendingDensities> start(const std::vector<Query>& queries) override {
    EXPECT_FALSE(working_.exchange(true)) << "two pieces at a time";
    const bool met = met_ || !meeting_ || meeting_->meet();
    EXPECT_TRUE(met) << "another device had no part";
    met_ = true;
    if (!failure_.empty()) throw DeviceError(failure_);
    std::this_thread::sleep_for(1ms);  // so that another piece would meet this one
    std::vector<float> answers;
    for (const Query& query : queries) answers.push_back(static_cast<float>(query.roughness));
    answered_ += queries.size();
    working_ = false;
    return std::make_unique<Pending>(answers);
  }

  std::size_t replaced() const override { return answered_; }
  std::string name() const override { return "echo"; }
  std::size_t device_bytes() const override { return 10; }
  double build_seconds() const override { return 0.5; }
  double device_seconds() const override { return 0.25; }

 private:
  Meeting* meeting_;
  std::string failure_;
  bool met_ = false;
  std::atomic<bool> working_{false};
  std::size_t answered_ = 0;
};

std::vector<Query> numbered(std::size_t count) {
  std::vector<Query> queries(count);
  for (std::size_t n = 0; n < count; ++n) queries[n].roughness = static_cast<double>(n);
  return queries;
}

std::vector<float> numbers(std::size_t count) {
  std::vector<float> all(count);
  for (std::size_t n = 0; n < count; ++n) all[n] = static_cast<float>(n);
  return all;
}

SharedEvaluator three(Meeting* meeting, const std::string& failure_of_last = "") {
  std::vector<DeviceShare> shares;
  for (int n = 0; n < 3; ++n)
    shares.push_back({"device " + std::to_string(n),
                      std::make_unique<Echo>(meeting, n == 2 ? failure_of_last : std::string())});
  return SharedEvaluator(std::move(shares));
}

TEST(SharedEvaluator, GivesEveryAnswerItsPlace) {
  for (const std::size_t count : {0, 1, 255, 256, 257, 10'000}) {
    SharedEvaluator shared = three(nullptr);
    EXPECT_EQ(shared.evaluate(numbered(count)), numbers(count));
    EXPECT_EQ(shared.replaced(), count) << "a query that was asked twice, or not at all";
  }
}

/// All three are at work at a time: each waits for the others before its first answer.
TEST(SharedEvaluator, HasAllDevicesWork) {
  Meeting meeting;
  meeting.expected = 3;
  SharedEvaluator shared = three(&meeting);
  EXPECT_EQ(shared.evaluate(numbered(10'000)), numbers(10'000));
  EXPECT_EQ(meeting.present, 3u);
}

TEST(SharedEvaluator, HasSeveralBatchesUnderWay) {
  SharedEvaluator shared = three(nullptr);
  const auto first = shared.start(numbered(5'000)), second = shared.start(numbered(7'000));
  EXPECT_EQ(second->wait(), numbers(7'000));
  EXPECT_EQ(first->wait(), numbers(5'000));
  const auto left = shared.start(numbered(5'000));  // nobody waits for it
}

TEST(SharedEvaluator, TellsColorsOfGlints) {
  SharedEvaluator shared = three(nullptr);
  const auto pending = shared.start_at(numbered(2'000), std::vector<GlintPoint>(2'000));
  EXPECT_EQ(pending->wait(), numbers(2'000));
  for (const std::size_t n : {0, 700, 1'999}) EXPECT_EQ(pending->density_of_color(2, n), n + 2.0f);
}

TEST(SharedEvaluator, NamesTheDeviceThatFails) {
  Meeting meeting;
  meeting.expected = 3;
  SharedEvaluator shared = three(&meeting, "out of memory");
  try {
    shared.evaluate(numbered(10'000));
    FAIL() << "nothing was thrown";
  } catch (const DeviceError& error) {
    EXPECT_STREQ(error.what(), "device 2: out of memory");
  }
}

TEST(SharedEvaluator, CountsTheBytesOfEachDevice) {
  const SharedEvaluator shared = three(nullptr);
  EXPECT_EQ(shared.device_bytes(), 30u);
  EXPECT_EQ(shared.build_seconds(), 1.5);
  EXPECT_EQ(shared.device_seconds(), 0.75);
  EXPECT_EQ(shared.name(), "echo");
}

}  // namespace
}  // namespace mica::host::shared_evaluator_test
