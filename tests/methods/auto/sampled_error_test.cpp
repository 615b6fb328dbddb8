// The error that a sample tells, and how sure one can be of it.
#include "host/methods/auto/sampled_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "host/base/random.h"

namespace mica::host::sampled_error_test {
namespace {

TEST(SampledError, IsTheRelativeL2) {
  const SampledError error = sampled_error({1.5f, 2, 1}, {1, 2, 2}, 1);
  EXPECT_NEAR(error.relative_l2, std::sqrt(1.25 / 9), 1e-12);
  EXPECT_LT(error.lower_bound, error.relative_l2);
  EXPECT_GT(error.upper_bound, error.relative_l2);
}

TEST(SampledError, OfExactDensitiesIsZeroAndOfNothingInfinite) {
  EXPECT_EQ(sampled_error({1, 2}, {1, 2}, 2).upper_bound, 0);
  EXPECT_EQ(sampled_error({1, 0}, {0, 0}, 2).upper_bound, std::numeric_limits<double>::infinity());
  EXPECT_EQ(sampled_error({0, 0}, {0, 0}, 2).upper_bound, std::numeric_limits<double>::infinity());
}

/// Many samples of queries with log-normal errors, for which the largest hundredth makes an eighth of the
/// squares: bounds at 95% hold for nearly as many, and the deviation is that of the errors.
TEST(SampledError, BoundsHoldWhereFewQueriesMakeMostOfTheError) {
  constexpr int samples = 1000, count = 256;
  constexpr double sigma = 0.6;  // standard deviation of the errors' logarithm
  const double truth = 0.01 * std::exp(sigma * sigma);
  int above = 0, below = 0;
  double square = 0, deviations = 0;
  for (int sample = 0; sample < samples; ++sample) {
    std::vector<float> densities(count), expected(count, 1.0f);
    for (int n = 0; n < count; ++n) {
      const auto random = [&](std::uint64_t stream) { return random_unit(3, stream, sample * count + n); };
      const double normal = std::sqrt(-2 * std::log(1 - random(0))) * std::cos(6.283185307179586 * random(1));
      densities[n] = static_cast<float>(1 + 0.01 * std::exp(sigma * normal));
    }
    const SampledError error = sampled_error(densities, expected, 1.645);
    above += error.upper_bound<truth, below += error.lower_bound> truth;
    square += std::pow(error.relative_l2 - truth, 2) / samples, deviations += error.deviation / samples;
  }
  std::printf("above %d, below %d of %d; deviation %.3g, said to be %.3g\n", above, below, samples,
              std::sqrt(square), deviations);
  EXPECT_LE(above, 0.08 * samples);
  EXPECT_LE(below, 0.05 * samples);
  EXPECT_NEAR(deviations, std::sqrt(square), 0.25 * std::sqrt(square));
}

}  // namespace
}  // namespace mica::host::sampled_error_test
