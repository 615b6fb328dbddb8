#include "host/scene/pixel_filter.h"

#include <gtest/gtest.h>

#include <cmath>

#include "host/base/constants.h"
#include "mica/error.h"

namespace mica::host::pixel_filter_test {
namespace {

double value(const FilterSum& sum, double x) {
  double result = 0;
  for (std::size_t n = 0; n < sum.weights.size(); ++n) {
    const double y = (x - sum.offsets_pixels[n]) / sum.sigma_pixels;
    result += sum.weights[n] * std::exp(-0.5 * y * y) / (sum.sigma_pixels * std::sqrt(2 * kPi));
  }
  return result;
}

/// Relative L2 between a sum and a density, by the trapezoid rule.
template <typename Density>
double difference(const FilterSum& sum, const Density& density) {
  double square = 0, all = 0;
  for (int n = -8000; n <= 8000; ++n) {
    const double x = n / 2000.0, d = value(sum, x) - density(x);
    square += d * d, all += density(x) * density(x);
  }
  return std::sqrt(square / all);
}

TEST(PixelFilter, SumsAreTheFilterWithinTheErrorThatTheySay) {
  for (const FilterKind kind : {FilterKind::gaussian, FilterKind::blackman_harris, FilterKind::box}) {
    const PixelFilter filter({kind, 0});
    const auto density = [&](double x) { return filter.density(x); };
    double integral = 0;
    for (int n = -4000; n < 4000; ++n) integral += filter.density((n + 0.5) / 1000) / 1000;
    EXPECT_NEAR(integral, 1, 1e-6);
    for (const FilterSum& sum : {filter.by_few(), filter.on_lattice(4), filter.on_lattice(8)}) {
      double total = 0;
      for (const double weight : sum.weights) {
        EXPECT_GE(weight, 0);
        total += weight;
      }
      EXPECT_NEAR(total, 1, 1e-12);
      EXPECT_NEAR(difference(sum, density), sum.relative_l2, 1e-3 + 1e-2 * sum.relative_l2);
    }
  }
}

TEST(PixelFilter, FewGaussiansAreEnough) {
  EXPECT_EQ(PixelFilter({FilterKind::gaussian, 0.5}).by_few().weights.size(), 1u);
  EXPECT_LT(PixelFilter({FilterKind::gaussian, 0.5}).on_lattice(4).relative_l2, 0.01);
  EXPECT_LT(PixelFilter({FilterKind::blackman_harris, 1.5}).by_few().relative_l2, 0.003);
  EXPECT_LT(PixelFilter({FilterKind::blackman_harris, 1.5}).on_lattice(8).relative_l2, 0.003);
  // A box has edges that no sum of Gaussians has.
  EXPECT_LT(PixelFilter({FilterKind::box, 1}).by_few().relative_l2, 0.19);
}

TEST(PixelFilter, LatticeLiesAtTheCentresOfSubpixels) {
  const FilterSum sum = PixelFilter({FilterKind::gaussian, 0.5}).on_lattice(4);
  ASSERT_EQ(sum.offsets_pixels.size(), 12u);  // three pixels
  EXPECT_NEAR(sum.offsets_pixels.front(), -1.375, 1e-15);
  EXPECT_NEAR(sum.offsets_pixels.back(), 1.375, 1e-15);
  for (std::size_t n = 0; n < sum.weights.size(); ++n)
    EXPECT_NEAR(sum.weights[n], sum.weights[sum.weights.size() - 1 - n], 1e-9);
}

TEST(PixelFilter, SubpixelsShareAPixelEvenly) {
  const FilterSum sum = PixelFilter({}).on_lattice(3);
  ASSERT_EQ(sum.weights.size(), 3u);
  for (const double weight : sum.weights) EXPECT_NEAR(weight, 1.0 / 3, 1e-15);
  EXPECT_NEAR(sum.sigma_pixels, 0.5 / 3, 1e-15);
  EXPECT_EQ(PixelFilter({}).margin_pixels(), 0);
}

/// A finer lattice stands for the same sum of Gaussians.
TEST(PixelFilter, SubpixelsAreTheSameOnAFinerLattice) {
  for (const int subpixels : {1, 3, 4}) {
    const PixelFilter filter = PixelFilter({}).for_reference(subpixels);
    const FilterSum sum = filter.on_lattice(8 * subpixels);
    EXPECT_LT(sum.relative_l2, 0.01) << subpixels;
    EXPECT_NEAR(difference(sum, [&](double x) { return filter.density(x); }), sum.relative_l2, 1e-3);
  }
  EXPECT_NEAR(PixelFilter({}).for_reference(4).density(0.125), PixelFilter({}).density(0.125), 1e-12);
}

TEST(PixelFilter, AReferenceCutsOffLess) {
  for (const FilterKind kind : {FilterKind::gaussian, FilterKind::blackman_harris}) {
    const PixelFilter filter({kind, 0});
    EXPECT_LT(filter.for_reference(4).on_lattice(8).relative_l2, 1e-3);
    EXPECT_LE(filter.for_reference(4).on_lattice(8).relative_l2, filter.on_lattice(8).relative_l2);
  }
}

TEST(PixelFilter, SplitsAreTheGaussianWithinSevenPerMille) {
  double before = 1;
  for (const GaussianSplit& split : gaussian_splits()) {
    EXPECT_LT(split.sigma, before);
    before = split.sigma;
    EXPECT_LT(split.parts.relative_l2, 7e-3) << split.sigma;
    EXPECT_NEAR(difference(split.parts, [](double x) { return std::exp(-0.5 * x * x) / std::sqrt(2 * kPi); }),
                split.parts.relative_l2, 1e-4);
  }
}

TEST(PixelFilter, RefusesAWidthThatIsNone) {
  for (const double width : {-1.0, std::nan(""), HUGE_VAL})
    EXPECT_THROW(PixelFilter({FilterKind::gaussian, width}), UsageError);
}

}  // namespace
}  // namespace mica::host::pixel_filter_test
