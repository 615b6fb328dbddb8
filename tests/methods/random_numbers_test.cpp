// The random numbers of draws: the generator's published answers, the same on device and host, uniform, and
// independent along every way in which keys and dimensions run.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "host/device/device.h"
#include "host/device/launch.h"
#include "host/reference/random_numbers.h"

namespace mica::host::random_numbers_test {
namespace {

using reference::random_bits;
using reference::random_uniform;

/// The known answers that come with the generator: counter, key, words.
TEST(RandomNumbers, AreThoseOfPhilox) {
  EXPECT_EQ(random_bits(0, 0), 0xff1dae59u);
  EXPECT_EQ(random_bits(0, 1), 0x6cd10df2u);
}

std::vector<float> on_device(Device* device, WaveForm form, std::uint64_t first_key, std::uint32_t dimension,
                             bool in_a_wave, std::size_t count) {
  cl::Kernel kernel = device->kernel("probes/random_numbers.cl", "random_numbers", "", form);
  const cl::Buffer alone = device->buffer(count * sizeof(float), CL_MEM_WRITE_ONLY, "numbers");
  const cl::Buffer lanes = device->buffer(count * sizeof(float), CL_MEM_WRITE_ONLY, "numbers");
  launch(*device, kernel, launch_size(form, count / kWaveLanes), static_cast<cl_uint>(first_key),
         static_cast<cl_uint>(first_key >> 32), static_cast<cl_uint>(dimension), alone, lanes);
  std::vector<float> numbers(count);
  device->queue().enqueueReadBuffer(in_a_wave ? lanes : alone, CL_TRUE, 0, count * sizeof(float),
                                    numbers.data());
  return numbers;
}

TEST(RandomNumbers, AreTheSameOnTheDevice) {
  Device device(0);
  constexpr std::size_t count = 4096;
  for (const WaveForm form : {WaveForm::vectors, WaveForm::items}) {
    for (const std::uint64_t key : {0ull, 0x0123456789abcdefull, 0xfffffffffffff000ull}) {
      for (const std::uint32_t dimension : {0u, 1u, 6u, 0xffffffffu}) {
        for (const bool in_a_wave : {false, true}) {
          const std::vector<float> numbers = on_device(&device, form, key, dimension, in_a_wave, count);
          for (std::size_t n = 0; n < count; ++n)
            ASSERT_EQ(static_cast<double>(numbers[n]), random_uniform(key + n, dimension))
                << key << " + " << n;
        }
      }
    }
  }
}

constexpr int kBins = 16, kSample = 1 << 17;

/// How many standard deviations a chi-square value lies above its mean. [Wilson, Hilferty 1931]
double deviations(double chi_square, double degrees) {
  const double c = 2 / (9 * degrees);
  return (std::cbrt(chi_square / degrees) - (1 - c)) / std::sqrt(c);
}
/// One of the 24 tests below passes it by chance with probability 0.01 [Sidak]: 1 - 0.99^(1/24) = 4.2e-4.
constexpr double kMostDeviations = 3.34;

/// Whether the pairs of numbers fill kBins x kBins squares alike.
double deviations_of_pairs(const std::function<std::pair<double, double>(int)>& pair) {
  std::vector<int> counts(kBins * kBins);
  for (int n = 0; n < kSample; ++n) {
    const auto [x, y] = pair(n);
    ++counts[static_cast<int>(kBins * x) * kBins + static_cast<int>(kBins * y)];
  }
  const double expected = static_cast<double>(kSample) / (kBins * kBins);
  double chi_square = 0;
  for (const int count : counts) chi_square += (count - expected) * (count - expected) / expected;
  return deviations(chi_square, kBins * kBins - 1);
}

TEST(RandomNumbers, AreUniformAndIndependent) {
  const std::uint64_t start = 0x5eed00000000;
  for (const std::uint32_t dimension : {0u, 1u, 2u, 7u}) {
    // Within one stream: each number with the next in it, and with the one after.
    for (const std::uint32_t step : {1u, 2u})
      EXPECT_LE(deviations_of_pairs([&](int n) {
                  return std::pair(random_uniform(start + n, dimension),
                                   random_uniform(start + n, dimension + step));
                }),
                kMostDeviations)
          << dimension << ", " << step;
    // Between two streams: consecutive ones, a row of pixels apart, and in the upper half.
    for (const std::uint64_t step : {std::uint64_t{1}, std::uint64_t{1280}, std::uint64_t{1} << 32})
      EXPECT_LE(deviations_of_pairs([&](int n) {
                  return std::pair(random_uniform(start + n, dimension),
                                   random_uniform(start + n + step, dimension));
                }),
                kMostDeviations)
          << dimension << ", " << step;
    // along the dimensions of one stream
    EXPECT_LE(deviations_of_pairs([&](int n) {
                return std::pair(random_uniform(start + dimension, 2 * n),
                                 random_uniform(start + dimension, 2 * n + 1));
              }),
              kMostDeviations)
        << dimension;
  }
}

TEST(RandomNumbers, WouldBeSeenToDepend) {
  EXPECT_GT(deviations_of_pairs([](int n) {
              const double x = random_uniform(n, 0);
              return std::pair(x, n % 32 == 0 ? x : random_uniform(n, 1));
            }),
            kMostDeviations);
}

/// One bit of the key turned over turns over each bit of the number half of the time.
TEST(RandomNumbers, ChangeAsAWholeWithEachBitOfTheKey) {
  constexpr int keys = 4096;
  for (int bit = 0; bit < 64; ++bit) {
    for (int out = 8; out < 32; ++out) {
      int changed = 0;
      for (int key = 0; key < keys; ++key)
        changed += (random_bits(key, 3) ^ random_bits(key ^ (std::uint64_t{1} << bit), 3)) >> out & 1;
      // 64 * 24 tests at 0.01 in all: 1 - 0.99^(1/1536) is 4.5 standard deviations, sqrt(keys) / 2 each.
      ASSERT_NEAR(changed, keys / 2, 4.5 * 32) << "bit " << bit << " of the key, " << out << " of the word";
    }
  }
}

}  // namespace
}  // namespace mica::host::random_numbers_test
