#include "host/measure/image_difference.h"

#include <gtest/gtest.h>

#include <cmath>

namespace mica::host::bench::image_difference_test {
namespace {

struct Pair {
  double l1, a1, b1, l2, a2, b2, difference;
};

/// The 34 pairs of Sharma, Wu and Dalal 2005, Table 1, with their four digits.
constexpr Pair kPairs[] = {{50, 2.6772, -79.7751, 50, 0, -82.7485, 2.0425},
                           {50, 3.1571, -77.2803, 50, 0, -82.7485, 2.8615},
                           {50, 2.8361, -74.0200, 50, 0, -82.7485, 3.4412},
                           {50, -1.3802, -84.2814, 50, 0, -82.7485, 1.0000},
                           {50, -1.1848, -84.8006, 50, 0, -82.7485, 1.0000},
                           {50, -0.9009, -85.5211, 50, 0, -82.7485, 1.0000},
                           {50, 0, 0, 50, -1, 2, 2.3669},
                           {50, -1, 2, 50, 0, 0, 2.3669},
                           {50, 2.4900, -0.0010, 50, -2.4900, 0.0009, 7.1792},
                           {50, 2.4900, -0.0010, 50, -2.4900, 0.0010, 7.1792},
                           {50, 2.4900, -0.0010, 50, -2.4900, 0.0011, 7.2195},
                           {50, 2.4900, -0.0010, 50, -2.4900, 0.0012, 7.2195},
                           {50, -0.0010, 2.4900, 50, 0.0009, -2.4900, 4.8045},
                           {50, -0.0010, 2.4900, 50, 0.0010, -2.4900, 4.8045},
                           {50, -0.0010, 2.4900, 50, 0.0011, -2.4900, 4.7461},
                           {50, 2.5, 0, 50, 0, -2.5, 4.3065},
                           {50, 2.5, 0, 73, 25, -18, 27.1492},
                           {50, 2.5, 0, 61, -5, 29, 22.8977},
                           {50, 2.5, 0, 56, -27, -3, 31.9030},
                           {50, 2.5, 0, 58, 24, 15, 19.4535},
                           {50, 2.5, 0, 50, 3.1736, 0.5854, 1.0000},
                           {50, 2.5, 0, 50, 3.2972, 0, 1.0000},
                           {50, 2.5, 0, 50, 1.8634, 0.5757, 1.0000},
                           {50, 2.5, 0, 50, 3.2592, 0.3350, 1.0000},
                           {60.2574, -34.0099, 36.2677, 60.4626, -34.1751, 39.4387, 1.2644},
                           {63.0109, -31.0961, -5.8663, 62.8187, -29.7946, -4.0864, 1.2630},
                           {61.2901, 3.7196, -5.3901, 61.4292, 2.2480, -4.9620, 1.8731},
                           {35.0831, -44.1164, 3.7933, 35.0232, -40.0716, 1.5901, 1.8645},
                           {22.7233, 20.0904, -46.6940, 23.0331, 14.9730, -42.5619, 2.0373},
                           {36.4612, 47.8580, 18.3852, 36.2715, 50.5065, 21.2231, 1.4146},
                           {90.8027, -2.0831, 1.4410, 91.1528, -1.6435, 0.0447, 1.4441},
                           {90.9257, -0.5406, -0.9208, 88.6381, -0.8985, -0.7239, 1.5381},
                           {6.7747, -0.2908, -2.4247, 5.8714, -0.0985, -2.2286, 0.6377},
                           {2.0776, 0.0795, -1.1350, 0.9033, -0.0636, -0.5514, 0.9082}};

TEST(Ciede2000, IsAsPublished) {
  for (const Pair& p : kPairs) {
    const Eigen::Vector3d first(p.l1, p.a1, p.b1), second(p.l2, p.a2, p.b2);
    EXPECT_NEAR(ciede2000(first, second), p.difference, 5e-5)
        << first.transpose() << ", " << second.transpose();
    EXPECT_NEAR(ciede2000(second, first), p.difference, 5e-5);
  }
}

TEST(Lab, OfWhiteAndBlackAndRed) {
  EXPECT_LT((lab_from_linear_rgb({1, 1, 1}) - Eigen::Vector3d(100, 0, 0)).norm(), 1e-9);
  EXPECT_LT(lab_from_linear_rgb({0, 0, 0}).norm(), 1e-9);
  // The standard's matrix has four digits, which leave 0.05 of b: 200 / 3 * 5e-5 / 0.0193 * cbrt(0.0193
  // / 1.089).
  EXPECT_LT((lab_from_linear_rgb({1, 0, 0}) - Eigen::Vector3d(53.24, 80.09, 67.20)).norm(), 0.05);
}

Image image_of(std::vector<float> pixels) {
  return {static_cast<int>(pixels.size() / 3), 1, {"R", "G", "B"}, std::move(pixels), {}};
}

TEST(RelativeMse, IsWeightedByTheReference) {
  const Image reference = image_of({1, 2, 0}), image = image_of({1.1f, 2, 0.2f});
  EXPECT_NEAR(relative_mse(image, reference), (0.01 / 1.01 + 0.04 / 0.01) / 3, 1e-6);
  EXPECT_EQ(relative_mse(reference, reference), 0);
}

TEST(DisplayDifference, SeesWhatIsDisplayed) {
  const Image black = image_of(std::vector<float>(30, 0.0f));
  std::vector<float> pixels(30, 0.0f);
  for (int c = 0; c < 3; ++c) pixels[12 + c] = 100;  // one of ten pixels
  const DisplayDifference difference = display_difference(image_of(pixels), black);
  EXPECT_NEAR(difference.pixels[4], 100, 1e-3);
  EXPECT_NEAR(difference.mean, 10, 1e-4);
  EXPECT_EQ(difference.percentile_95, 0);
}

}  // namespace
}  // namespace mica::host::bench::image_difference_test
