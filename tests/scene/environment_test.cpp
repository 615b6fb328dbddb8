#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "host/base/constants.h"
#include "host/image/image.h"
#include "host/microfacet/low_discrepancy.h"
#include "host/scene/environment.h"
#include "host/scene/piecewise_constant.h"
#include "tests/image/folder.h"

namespace mica::host::environment_test {
namespace {

class EnvironmentTest : public FolderTest {
 protected:
  /// Writes a grey image, row by row from the top.
  std::string image(int width, int height, const std::vector<float>& pixels) const {
    Image grey{width, height, {"R", "G", "B"}, {}, {}};
    for (const float pixel : pixels) grey.pixels.insert(grey.pixels.end(), {pixel, pixel, pixel});
    write_exr(path("sky.exr"), grey);
    return path("sky.exr");
  }
  /// Black but for one pixel, and a dim band.
  std::string lamp() const {
    std::vector<float> pixels(16 * 8, 0.0f);
    pixels[2 * 16 + 15] = 100;  // at the seam
    for (int column = 3; column < 9; ++column) pixels[static_cast<std::size_t>(5 * 16 + column)] = 1;
    return image(16, 8, pixels);
  }
};

Eigen::Vector3d direction(double azimuth, double z) {
  const double radius = std::sqrt(1 - z * z);
  return {radius * std::cos(azimuth), radius * std::sin(azimuth), z};
}

/// Integral over all directions by midpoints.
template <typename Function>
double over_sphere(int steps, const Function& f) {
  double sum = 0;
  for (int j = 0; j < steps; ++j)
    for (int i = 0; i < 2 * steps; ++i)
      sum += f(direction(kPi * (i + 0.5) / steps, -1 + 2 * (j + 0.5) / steps));
  return sum * 4 * kPi / (2.0 * steps * steps);
}

TEST(PiecewiseConstant, ChoosesByWeightAndNeverWhatHasNone) {
  const PiecewiseConstant choice({0, 1, 0, 3, 0});
  EXPECT_EQ(choice.sum(), 4);
  EXPECT_EQ(choice.probability(3), 0.75);
  EXPECT_EQ(choice.probability(4), 0);
  for (const auto& [uniform, item, rest] : std::vector<std::tuple<double, std::size_t, double>>{
           {0, 1, 0}, {0.125, 1, 0.5}, {0.25, 3, 0}, {0.625, 3, 0.5}, {1 - 0x1p-53, 3, 1 - 0x1p-53}}) {
    double left = uniform;
    EXPECT_EQ(choice.sample(&left), item) << uniform;
    EXPECT_NEAR(left, rest, 1e-15) << uniform;
    EXPECT_LT(left, 1);
  }
}

TEST(LowDiscrepancy, EveryBoxOfEqualAreaGetsOnePoint) {
  for (const std::uint64_t scramble : {0ull, 0x9e3779b97f4a7c15ull})
    for (int log_x = 0; log_x <= 6; ++log_x) {
      std::vector<int> count(64, 0);
      for (std::uint32_t n = 128; n < 192; ++n) {
        const Eigen::Vector2d p = low_discrepancy_point(n, scramble);
        const int x = static_cast<int>(p.x() * (1 << log_x)), y = static_cast<int>(p.y() * (64 >> log_x));
        ++count[static_cast<std::size_t>(x * (64 >> log_x) + y)];
      }
      EXPECT_EQ(count, std::vector<int>(64, 1)) << log_x;
    }
}

TEST_F(EnvironmentTest, PointsOfFourDimensionsAreANet) {
  // Of 2^m points 8 fall into each box of volume 2^(3 - m): t = 0 + 0 + 1 + 2, the polynomials' degrees
  // less 1.
  for (int code = 0; code < 256; ++code) {
    const int logs[] = {code & 3, (code >> 2) & 3, (code >> 4) & 3, code >> 6};
    if (logs[0] + logs[1] + logs[2] + logs[3] != 3) continue;
    std::vector<int> count(8, 0);
    for (std::uint32_t n = 128; n < 192; ++n) {
      const Eigen::Vector4d p = low_discrepancy_point4(n, 0x123456789abcdef0u, 0xfedcba9876543210u);
      int box = 0;
      for (int k = 0; k < 4; ++k) box = (box << logs[k]) + static_cast<int>(p[k] * (1 << logs[k]));
      ++count[static_cast<std::size_t>(box)];
    }
    EXPECT_EQ(count, std::vector<int>(8, 8)) << code;
  }
}

TEST_F(EnvironmentTest, DensityIsOneInAllAndNowhereZeroWhereLightIs) {
  const Environment environment({{lamp(), {2, 2, 2}, 45}});  // two pixels
  double sum = 0;
  constexpr int rows = 8 * 3, columns = 16 * 3;
  for (int row = 0; row < rows; ++row) {
    const double top = std::cos(kPi * row / rows), bottom = std::cos(kPi * (row + 1) / rows);
    for (int column = 0; column < columns; ++column)
      sum += environment.pdf(direction(2 * kPi * (column + 0.5) / columns, (top + bottom) / 2)) *
             (top - bottom) * 2 * kPi / columns;
  }
  EXPECT_NEAR(sum, 1, 1e-12);
  over_sphere(300, [&](const Eigen::Vector3d& d) {
    EXPECT_TRUE(environment.pdf(d) > 0 || environment.radiance(d).isZero(0)) << d.transpose();
    return 0;
  });
}

TEST_F(EnvironmentTest, DirectionsAreDrawnWithTheirDensity) {
  const Environment environment({{lamp(), {1, 1, 1}, -77}, {"", {0.3, 0.2, 0.1}, 0}, {"", {0, 0, 0}, 0}});
  constexpr int columns = 24, rows = 12, draws = 200000, part = 40;
  std::vector<double> counts(columns * rows, 0.0);
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform;
  const auto draw = [&] {
    const double x = uniform(random);
    return Eigen::Vector2d(x, uniform(random));
  };
  for (int n = 0; n < draws; ++n) {
    const Eigen::Vector3d d = environment.sample(draw());
    ASSERT_NEAR(d.norm(), 1, 1e-12);
    const int column =
        std::min(static_cast<int>((std::atan2(d.y(), d.x()) / kPi + 1) / 2 * columns), columns - 1);
    const int row = std::min(static_cast<int>((d.z() + 1) / 2 * rows), rows - 1);
    ++counts[static_cast<std::size_t>(row * columns + column)];
  }
  double chi_square = 0;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      double probability = 0;
      for (int k = 0; k < part * part; ++k)
        probability += environment.pdf(direction(2 * kPi * (column + (k % part + 0.5) / part) / columns - kPi,
                                                 -1 + 2 * (row + (k / part + 0.5) / part) / rows));
      const double expected = draws * probability * 4 * kPi / (columns * rows * part * part);
      ASSERT_GT(expected, 5);
      chi_square +=
          std::pow(counts[static_cast<std::size_t>(row * columns + column)] - expected, 2) / expected;
    }
  // Mean 287, standard deviation 24; the midpoints miss the edges of pixels by 1e-3 of a bin's probability.
  EXPECT_LT(chi_square, 287 + 5 * 24);
}

TEST_F(EnvironmentTest, RotationTurnsFromXTowardsY) {
  std::vector<float> pixels(16 * 8, 0.0f);
  for (int column = 7; column < 9; ++column)
    for (int row = 3; row < 5; ++row) pixels[static_cast<std::size_t>(row * 16 + column)] = 1;  // +y
  const std::string sky = image(16, 8, pixels);
  EXPECT_NEAR(Environment({{sky, {1, 2, 3}, 0}}).radiance({0, 1, 0}).z(), 3, 1e-6);
  EXPECT_NEAR(Environment({{sky, {1, 2, 3}, 90}}).radiance({-2, 0, 0}).z(), 3, 1e-6);
  EXPECT_NEAR(Environment({{sky, {1, 2, 3}, -90}}).radiance({1, 0, 0}).z(), 3, 1e-6);
  const Environment turned({{sky, {1, 1, 1}, 90}});
  EXPECT_GT(turned.sample({0.5, 0.5}).dot(Eigen::Vector3d(-1, 0, 0)), 0.8);
}

TEST_F(EnvironmentTest, FurnacesAddUpAndBlackOnesAreNone) {
  const Environment two({{"", {1, 2, 3}, 0}, {"", {0.5, 0.5, 0.5}, 0}});
  EXPECT_TRUE(two.radiance({1, 2, -3}).isApprox(Color(1.5, 2.5, 3.5), 1e-15));
  EXPECT_NEAR(two.pdf({1, 2, -3}), 1 / (4 * kPi), 1e-15);
  const Environment none({{"", {0, 0, 0}, 0}});
  EXPECT_TRUE(none.is_black());
  EXPECT_EQ(none.pdf({0, 0, 1}), 0);
  EXPECT_TRUE(none.radiance({0, 0, 1}).isZero(0));
}

TEST_F(EnvironmentTest, UnusableImagesAreRefused) {
  EXPECT_EQ(error([&] {
              Environment({{path("none.exr"), {1, 1, 1}, 0}});
            }),
            path("none.exr") + ": cannot read: No such file or directory");
  const std::string sky = image(4, 2, {0, 0, 0, 0, 0, 0, -1, 0});
  EXPECT_EQ(error([&] {
              Environment({{sky, {1, 1, 1}, 0, {}, TexelRepair::refuse}});
            }),
            sky + ": pixel (2, 1) from the top left is -1, expected radiance, which is not negative");
  Findings findings;
  EXPECT_TRUE(Environment({{sky, {1, 1, 1}, 0}}, &findings).is_black());
  EXPECT_EQ(findings.notes.size(), 1u);
}

}  // namespace
}  // namespace mica::host::environment_test
