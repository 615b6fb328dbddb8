// P-NDFs of small squares against sums over points.
#include "host/surface/tile_density.h"

#include <gtest/gtest.h>

#include <cmath>

#include "host/base/constants.h"
#include "host/base/random.h"

namespace mica::host::tile_density_test {
namespace {

constexpr int kSide = 7, kMargin = 2;
constexpr double kSigma = 1.5, kRoughness = 2;

/// Of 250 points along each side of a quad.
double by_points(const PairGrid& normals, const Eigen::Vector2f& half_vector) {
  constexpr int points = 250;
  const auto at = [&](int i, int j) {
    const std::complex<float>& n = normals[static_cast<std::size_t>(j) * kSide + i];
    return Eigen::Vector2d(n.real(), n.imag());
  };
  double sum = 0, weights = 0;
  for (int j = kMargin; j + kMargin < kSide; ++j)
    for (int i = kMargin; i + kMargin < kSide; ++i) {
      const double weight =
          std::exp(-0.5 * (std::pow(i + 0.5 - 0.5 * kSide, 2) + std::pow(j + 0.5 - 0.5 * kSide, 2)) /
                   (kSigma * kSigma));
      double lobes = 0;
      for (int b = 0; b < points; ++b)
        for (int a = 0; a < points; ++a) {
          const double x = (a + 0.5) / points, y = (b + 0.5) / points;
          const Eigen::Vector2d right = at(i + 1, j), up = at(i, j + 1);
          const Eigen::Vector2d normal = x + y < 1 ? at(i, j) + x * (right - at(i, j)) + y * (up - at(i, j))
                                                   : at(i + 1, j + 1) + (1 - x) * (up - at(i + 1, j + 1)) +
                                                         (1 - y) * (right - at(i + 1, j + 1));
          lobes += std::exp(-0.5 * (normal - half_vector.cast<double>()).squaredNorm() /
                            (kRoughness * kRoughness));
        }
      sum += weight * lobes / (points * points), weights += weight;
    }
  return sum / (weights * 2 * kPi * kRoughness * kRoughness);
}

/// Normals that differ by so many roughnesses along an axis and across it.
PairGrid random_normals(double along, double across) {
  PairGrid normals;
  for (int n = 0; n < kSide * kSide; ++n) {
    const double x = along * (random_unit(3, 0, n) - 0.5), y = across * (random_unit(3, 1, n) - 0.5);
    normals.emplace_back(static_cast<float>(kRoughness * (0.8 * x - 0.6 * y)),
                         static_cast<float>(kRoughness * (0.6 * x + 0.8 * y)));
  }
  return normals;
}

/// From triangles narrow beside a lobe to wide ones, and slivers of any angle.
TEST(TileDensity, IsThatOfItsPoints) {
  for (const auto& [along, across] :
       {std::pair{0.5, 0.5}, {3.0, 2.0}, {40.0, 40.0}, {100.0, 1.0}, {60.0, 0.0}}) {
    const PairGrid normals = random_normals(along, across);
    const TileDensity density(kSide, normals, Interpolation::bilinear, kMargin, kSigma, kRoughness);
    double difference = 0, square = 0;
    for (int n = 0; n < 8; ++n) {
      const Eigen::Vector2f half_vector = density.draw(5, n);
      int looked_at = 0;
      const double expected = by_points(normals, half_vector);
      difference += std::pow(density.at(half_vector, &looked_at) - expected, 2);
      square += expected * expected;
    }
    EXPECT_LE(std::sqrt(difference / square), 0.01) << along << ", " << across;
  }
}

/// Half vectors are drawn from the density: the mean of 1 / density is the area where they fall.
TEST(TileDensity, DrawsFollowIt) {
  const PairGrid normals = random_normals(1, 1);
  const TileDensity density(kSide, normals, Interpolation::bilinear, kMargin, kSigma, kRoughness);
  constexpr int draws = 20'000;
  constexpr double radius = 1.5 * kRoughness;
  double sum = 0;
  for (int n = 0; n < draws; ++n) {
    const Eigen::Vector2f half_vector = density.draw(6, n);
    int looked_at = 0;
    if (half_vector.norm() < radius) sum += 1 / density.at(half_vector, &looked_at);
  }
  EXPECT_NEAR(sum / draws / (kPi * radius * radius), 1, 0.03);  // four standard deviations
}

}  // namespace
}  // namespace mica::host::tile_density_test
