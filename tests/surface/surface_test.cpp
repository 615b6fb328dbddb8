#include "host/surface/surface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "host/base/random.h"
#include "host/surface/disk.h"
#include "host/surface/export.h"
#include "mica/error.h"

namespace mica::host::surface_test {
namespace {

using Normals = std::vector<Eigen::Vector2d>;

TEST(Surface, WrapsTexelIndices) {
  const Surface surface(3, 2, Interpolation::bilinear,
                        {{0.0, 0}, {0.1, 0}, {0.2, 0}, {0, 0.1}, {0.1, 0.1}, {0.2, 0.1}});
  EXPECT_EQ(surface.texel(1, 0), Eigen::Vector2d(0.1, 0));
  EXPECT_EQ(surface.texel(-1, 0), Eigen::Vector2d(0.2, 0));
  EXPECT_EQ(surface.texel(3, 2), Eigen::Vector2d(0, 0));
  EXPECT_EQ(surface.texel(-3000000001, -3000000001), Eigen::Vector2d(0.2, 0.1));
}

TEST(Surface, RefusesWhatIsNoMapOfNormals) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto make = [](int width, int height, Normals normals) {
    Surface(width, height, Interpolation::bilinear, std::move(normals));
  };
  EXPECT_THROW(make(2, 2, Normals(3, {0, 0})), UsageError);
  EXPECT_THROW(make(0, 0, {}), UsageError);
  EXPECT_THROW(make(-2, -2, Normals(4, {0, 0})), UsageError);
  EXPECT_THROW(make(1, 1, {{1, 0}}), UsageError);
  EXPECT_THROW(make(1, 1, {{0, nan}}), UsageError);
  EXPECT_NO_THROW(make(1, 1, {{0.9999, 0}}));
}

TEST(Surface, ExportsTheTopRowFirst) {
  const Surface surface(1, 2, Interpolation::bilinear, {{0.6, 0}, {0, -0.8}});  // v near 0, then above it
  const std::vector<float> expected{0, -0.8f, 0.6f, 0.6f, 0, 0.8f};
  const std::vector<float> pixels = to_signed_rgb(surface);
  ASSERT_EQ(pixels.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(pixels[i], expected[i], 1e-7) << i;
}

TEST(Disk, SlopeIsMinusTheNormalOverItsHeight) {
  const Eigen::Vector3d n = Eigen::Vector3d(0.3, -0.5, 0.7).normalized();
  const Eigen::Vector2d slope(-n.x() / n.z(), -n.y() / n.z());
  EXPECT_LT((disk_from_slope(slope) - n.head<2>()).norm(), 1e-15);
  EXPECT_LT((slope_from_disk(n.head<2>()) - slope).norm(), 1e-15);
}

TEST(Random, IsUniformAndUncorrelated) {
  const int count = 100000;
  double sum = 0, squares = 0, neighbours = 0, streams = 0, seeds = 0;
  for (int i = 0; i < count; ++i) {
    const double x = random_unit(7, 3, i) - 0.5;
    ASSERT_GE(x, -0.5);
    ASSERT_LT(x, 0.5);
    sum += x;
    squares += x * x;
    neighbours += x * (random_unit(7, 3, i + 1) - 0.5);
    streams += x * (random_unit(7, 4, i) - 0.5);
    seeds += x * (random_unit(8, 3, i) - 0.5);
  }
  const double variance = 1.0 / 12, four_sigma = 4 * std::sqrt(1.0 / count);
  EXPECT_NEAR(sum / count, 0, four_sigma * std::sqrt(variance));
  EXPECT_NEAR(squares / count, variance, four_sigma * std::sqrt(1.0 / 180));
  EXPECT_NEAR(neighbours / count, 0, four_sigma * variance);
  EXPECT_NEAR(streams / count, 0, four_sigma * variance);
  EXPECT_NEAR(seeds / count, 0, four_sigma * variance);
}

}  // namespace
}  // namespace mica::host::surface_test
