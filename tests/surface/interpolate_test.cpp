#include "host/surface/interpolate.h"

#include <gtest/gtest.h>

#include <cmath>

#include "host/base/random.h"

namespace mica::host::interpolate_test {
namespace {

using Function = Eigen::Vector2d (*)(double x, double y);

/// A surface that samples `function` at texel centres, x and y in texels from the centre of texel (0, 0).
Surface sampled(int width, int height, Interpolation interpolation, Function function) {
  std::vector<Eigen::Vector2d> normals;
  for (int j = 0; j < height; ++j) {
    for (int i = 0; i < width; ++i) normals.push_back(function(i, j));
  }
  return Surface(width, height, interpolation, normals);
}

Surface noise(Interpolation interpolation) {
  std::vector<Eigen::Vector2d> normals;
  for (int texel = 0; texel < 7 * 5; ++texel) {
    normals.push_back({random_unit(1, 0, texel) - 0.5, random_unit(1, 1, texel) - 0.5});
  }
  return Surface(7, 5, interpolation, normals);
}

const Interpolation kContinuous[] = {Interpolation::bilinear, Interpolation::bicubic};

TEST(Interpolate, MeetsTexelsAtTheirCentres) {
  for (const Interpolation interpolation :
       {Interpolation::nearest, Interpolation::bilinear, Interpolation::bicubic}) {
    const Surface surface = noise(interpolation);
    for (int j = -5; j < 10; ++j) {
      for (int i = -7; i < 14; ++i) EXPECT_EQ(normal_at(surface, {i + 0.5, j + 0.5}), surface.texel(i, j));
    }
  }
}

TEST(Interpolate, NearestIsConstantInATexel) {
  const Surface surface = noise(Interpolation::nearest);
  for (const double x : {2.0, 2.3, 2.999999}) {
    for (const double y : {4.0, 4.5, 4.999999}) EXPECT_EQ(normal_at(surface, {x, y}), surface.texel(2, 4));
  }
  EXPECT_EQ(normal_at(surface, {-0.001, -0.001}), surface.texel(6, 4));
}

TEST(Interpolate, SplitsQuadsFromLowerRightToUpperLeft) {
  // Only the upper right corner of the quad between texels (2, 2) and (3, 3) is not zero: the lower triangle
  // is flat.
  const Surface surface = sampled(6, 6, Interpolation::bilinear, [](double x, double y) {
    return x == 3 && y == 3 ? Eigen::Vector2d(0.5, -0.25) : Eigen::Vector2d(0, 0);
  });
  EXPECT_EQ(normal_at(surface, {2.5 + 0.5, 2.5 + 0.5}), Eigen::Vector2d(0, 0));
  EXPECT_EQ(normal_at(surface, {2.5 + 0.25, 2.5 + 0.625}), Eigen::Vector2d(0, 0));
  EXPECT_EQ(normal_at(surface, {2.5 + 0.75, 2.5 + 0.75}), Eigen::Vector2d(0.25, -0.125));  // f + g - 1 = 1/2
  EXPECT_EQ(normal_at(surface, {2.5 + 0.375, 2.5 + 0.875}), Eigen::Vector2d(0.125, -0.0625));  // 1/4
}

TEST(Interpolate, HasTheValuesOfBothTriangles) {
  // Corners 0.1, 0.2 (right), 0.4 (top), 0.8 (opposite).
  const Surface surface(2, 2, Interpolation::bilinear, {{0.1, 0}, {0.2, 0}, {0.4, 0}, {0.8, 0}});
  EXPECT_NEAR(normal_at(surface, {0.5 + 0.2, 0.5 + 0.3}).x(), 0.1 + 0.2 * 0.1 + 0.3 * 0.3, 1e-15);
  EXPECT_NEAR(normal_at(surface, {0.5 + 0.8, 0.5 + 0.7}).x(), 0.8 - 0.2 * 0.4 - 0.3 * 0.6, 1e-15);
  // The quad across the seam, whose corners are 0.8, 0.4 (right), 0.2 (top), 0.1 (opposite).
  EXPECT_NEAR(normal_at(surface, {1.5 + 0.2, 1.5 + 0.3}).x(), 0.8 - 0.2 * 0.4 - 0.3 * 0.6, 1e-15);
}

TEST(Interpolate, IsContinuousAndPeriodic) {
  const double step = 1e-9;
  for (const Interpolation interpolation : kContinuous) {
    const Surface surface = noise(interpolation);
    const double steepest = 20;  // change a texel; a jump would be of the order of 0.1
    for (int sample = 0; sample < 4000; ++sample) {
      // Points on the lines x = k / 8, y = k / 8, x + y = k / 8, which hold every edge of every triangle.
      const double along = 7 * random_unit(2, 0, sample);
      const double line = std::floor(56 * random_unit(2, 1, sample)) / 8;
      const Eigen::Vector2d points[] = {{line, along}, {along, line}, {along, line - along}};
      for (const Eigen::Vector2d& point : points) {
        const Eigen::Vector2d here = normal_at(surface, point);
        for (const Eigen::Vector2d& move : {Eigen::Vector2d(step, step), Eigen::Vector2d(-step, -step)}) {
          EXPECT_LT((normal_at(surface, point + move) - here).norm(), 2 * steepest * step);
        }
        EXPECT_LT((normal_at(surface, point + Eigen::Vector2d(-7 * 11, 5 * 13)) - here).norm(), 1e-12);
      }
    }
  }
}

TEST(Interpolate, ReproducesLinearNormals) {
  const Function linear = [](double x, double y) {
    return Eigen::Vector2d(0.02 * x - 0.03 * y, 0.05 * y - 0.1);
  };
  for (const Interpolation interpolation : kContinuous) {
    const Surface surface = sampled(12, 12, interpolation, linear);
    for (int sample = 0; sample < 1000; ++sample) {
      const double x = 2 + 7 * random_unit(3, 0, sample), y = 2 + 7 * random_unit(3, 1, sample);
      EXPECT_LT((normal_at(surface, {x + 0.5, y + 0.5}) - linear(x, y)).norm(), 1e-15);
    }
  }
}

TEST(Interpolate, BicubicVerticesReproduceQuadratics) {
  // Catmull-Rom's tangents are central differences, exact for quadratics; cubics are out of its reach.
  const Function quadratic = [](double x, double y) {
    return Eigen::Vector2d(0.004 * x * x - 0.003 * x * y, 0.002 * y * y + 0.0001 * x * x * y * y);
  };
  const Surface surface = sampled(10, 10, Interpolation::bicubic, quadratic);
  for (long b = 4; b <= 28; ++b) {
    for (long a = 4; a <= 28; ++a) {
      const Eigen::Vector2d expected =
          quadratic(0.25 * static_cast<double>(a), 0.25 * static_cast<double>(b));
      EXPECT_LT((bicubic_vertex(surface, a, b) - expected).norm(), 1e-15) << a << ", " << b;
    }
  }
}

TEST(Interpolate, BicubicIsLinearBetweenItsVertices) {
  const Surface surface = noise(Interpolation::bicubic);
  for (long b = -3; b < 24; ++b) {
    for (long a = -3; a < 31; ++a) {
      const auto at = [&](double f, double g) {
        return normal_at(surface,
                         {(static_cast<double>(a) + f) / 4 + 0.5, (static_cast<double>(b) + g) / 4 + 0.5});
      };
      const Eigen::Vector2d right = bicubic_vertex(surface, a + 1, b),
                            top = bicubic_vertex(surface, a, b + 1);
      EXPECT_LT((at(0.5, 0.5) - (right + top) / 2).norm(), 1e-14);
      EXPECT_LT((at(0.25, 0.25) - (bicubic_vertex(surface, a, b) / 2 + (right + top) / 4)).norm(), 1e-14);
      EXPECT_LT((at(0.75, 0.75) - (bicubic_vertex(surface, a + 1, b + 1) / 2 + (right + top) / 4)).norm(),
                1e-14);
    }
  }
}

TEST(Interpolate, CatmullRomWeightsFollowTheHermiteForm) {
  for (const double f : {0.0, 0.1, 0.25, 0.5, 0.9, 1.0}) {
    // Hermite basis for the values, half differences for the tangents.
    const double h00 = (1 + 2 * f) * (1 - f) * (1 - f), h01 = f * f * (3 - 2 * f);
    const double h10 = f * (1 - f) * (1 - f), h11 = f * f * (f - 1);
    const Eigen::Vector4d expected(-h10 / 2, h00 - h11 / 2, h01 + h10 / 2, h11 / 2);
    EXPECT_LT((catmull_rom_weights(f) - expected).norm(), 1e-15) << f;
  }
}

}  // namespace
}  // namespace mica::host::interpolate_test
