// The random numbers of the glints: uniform, and independent of each other and of those next to them.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "host/reference/glint_grid.h"

namespace mica::host::reference::glint_statistics_test {
namespace {

constexpr int kBins = 16, kTests = 200;  // tests: at least as many as are made below
constexpr int kSide = 32;                // cells a side of the sample: 2^20 in all

/// A glint as the five numbers it is made of.
double number(const Glint& glint, int which) {
  return which < 2 ? glint.place[which] : which < 4 ? glint.angle[which - 2] : glint.roulette;
}

/// How many standard deviations a chi-square value lies above its mean. [Wilson, Hilferty 1931]
double deviations(double chi_square, double degrees) {
  const double c = 2 / (9 * degrees);
  return (std::cbrt(chi_square / degrees) - (1 - c)) / std::sqrt(c);
}
/// The deviation that one of kTests passes by chance with probability 0.01 [Sidak]: 1 - 0.99^(1 / 200) =
/// 5e-5.
constexpr double kMostDeviations = 3.89;

/// Whether pairs of numbers fill kBins x kBins squares alike.
double deviations_of_pairs(
    const std::function<std::pair<double, double>(const Glint&, int i, int j, int k, int l)>& pair) {
  std::vector<int> counts(kBins * kBins);
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j)
      for (int k = 0; k < kSide; ++k)
        for (int l = 0; l < kSide; ++l) {
          const auto [x, y] = pair(glint_of_cell(i, j, k, l, 5, 1), i, j, k, l);
          ++counts[static_cast<int>(kBins * x) * kBins + static_cast<int>(kBins * y)];
        }
  const double expected = std::pow(kSide, 4) / (kBins * kBins);
  double chi_square = 0;
  for (const int count : counts) chi_square += (count - expected) * (count - expected) / expected;
  return deviations(chi_square, kBins * kBins - 1);
}

TEST(GlintStatistics, NumbersOfAGlintAreUniformAndIndependent) {
  for (int a = 0; a < 5; ++a)
    for (int b = 0; b < a; ++b)
      EXPECT_LE(deviations_of_pairs([&](const Glint& glint, int, int, int, int) {
                  return std::pair(number(glint, a), number(glint, b));
                }),
                kMostDeviations)
          << a << " and " << b;
}

TEST(GlintStatistics, NeighboursAreIndependent) {
  struct Step {
    int i, j, k, l, level;
    std::uint32_t seed;
  };
  // Along every axis, across them, to the next level, to the next seed.
  const std::vector<Step> steps = {
      {1, 0, 0, 0, 5, 1}, {0, 1, 0, 0, 5, 1},  {0, 0, 1, 0, 5, 1}, {0, 0, 0, 1, 5, 1}, {1, 1, 0, 0, 5, 1},
      {0, 0, 1, 1, 5, 1}, {1, 0, 0, -1, 5, 1}, {0, 0, 0, 0, 6, 1}, {0, 0, 0, 0, 5, 2}, {64, 0, 0, 0, 5, 1}};
  for (std::size_t n = 0; n < steps.size(); ++n) {
    const Step& s = steps[n];
    for (int which = 0; which < 5; ++which)
      EXPECT_LE(deviations_of_pairs([&](const Glint& glint, int i, int j, int k, int l) {
                  const Glint other = glint_of_cell(i + s.i, j + s.j, k + s.k, l + s.l, s.level, s.seed);
                  return std::pair(number(glint, which), number(other, which));
                }),
                kMostDeviations)
          << "step " << n << ", number " << which;
  }
}

TEST(GlintStatistics, WouldSeeACorrelation) {
  EXPECT_GT(deviations_of_pairs([](const Glint& glint, int i, int, int, int) {
              return std::pair(glint.place.x(),
                               i == 0 ? glint.place.x() : glint.place.y());  // in one row of 32
            }),
            kMostDeviations);
}

}  // namespace
}  // namespace mica::host::reference::glint_statistics_test
