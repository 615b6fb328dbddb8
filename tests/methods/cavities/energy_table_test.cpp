// The table of lost energy: its quadrature against plain sums, its interpolation, and its limits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "host/methods/cavities/energy_table.h"

namespace mica::host::energy_table_test {
namespace {

/// [Che19] Eq. 8 of a cavity of slopes (x, y), x towards the view, by the paper's own formulas.
double energy_of_slopes(double x, double y, double cosine) {
  const double sine = std::sqrt(1 - cosine * cosine), squared = 1 / (1 + x * x + y * y);
  double energy = 0, areas = 0;
  for (const double side : {1.0, -1.0}) areas += std::max(cosine + side * x * sine, 0.0);
  for (const double side : {1.0, -1.0}) {
    const double area = std::max(cosine + side * x * sine, 0.0);  // o.m / m_z
    if (area == 0) continue;
    const double height = 2 * area * squared - cosine;  // height of the image r
    const double other = std::max(2 * height - area, 0.0);
    if (height > 0) energy += area / areas * std::min(1.0, 2 * height / (area + other));
  }
  return energy;
}

double mean_by_sum(double alpha, double cosine) {
  constexpr int steps = 1000;
  const double sigma = alpha / std::sqrt(2.0);
  double sum = 0, weights = 0;
  for (int a = 0; a < steps; ++a) {
    for (int b = 0; b < steps; ++b) {
      const double x = 6 * (a + 0.5) / steps, y = 6 * (b + 0.5) / steps,
                   weight = std::exp(-0.5 * (x * x + y * y));
      weights += weight;
      sum += weight * energy_of_slopes(sigma * x, sigma * y, cosine);
    }
  }
  return sum / weights;
}

TEST(EnergyTable, QuadratureIsTheSumOverSlopes) {
  for (const double alpha : {0.02, 0.1, 0.5, 1.0, 3.0})
    for (const double degrees : {0.0, 30.0, 60.0, 80.0, 89.0})
      EXPECT_NEAR(mean_cavity_energy(alpha, std::cos(degrees * M_PI / 180)),
                  mean_by_sum(alpha, std::cos(degrees * M_PI / 180)), 2e-4)
          << alpha << ", " << degrees;
}

TEST(EnergyTable, InterpolatesToOneInAThousand) {
  const EnergyTable table;
  double worst = 0;
  for (int n = 0; n < 4000; ++n) {
    const double alpha = std::pow(10, -3 + 4 * std::fmod(n * 0.6180339887, 1)),
                 cosine = 1e-4 + (1 - 1e-4) * std::pow(std::fmod(n * 0.7548776662, 1), 3);
    const double error = std::abs(table.energy(alpha, cosine) - mean_cavity_energy(alpha, cosine));
    worst = std::max(worst, error);
  }
  EXPECT_LE(worst, 1e-3);
}

TEST(EnergyTable, HasItsLimits) {
  const EnergyTable table;
  EXPECT_NEAR(table.energy(0, 1), 1, 1e-6);  // a flat mirror
  EXPECT_NEAR(table.energy(1e-9, 0.3), 1, 1e-6);
  EXPECT_LT(table.energy(15, 1), 0.01);  // needles swallow what comes from above
  EXPECT_EQ(table.energy(100, 1), table.energy(15, 1));
  for (const double alpha : {0.0, 0.3, 15.0}) {
    EXPECT_TRUE(std::isfinite(table.energy(alpha, 1e-12)));
    EXPECT_TRUE(std::isfinite(table.energy(alpha, 1)));
  }
}

}  // namespace
}  // namespace mica::host::energy_table_test
