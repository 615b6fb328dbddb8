// The double-precision cavities: closed forms, symmetry, and what leaves them is what they are said to let
// go.
#include <gtest/gtest.h>

#include <cmath>

#include "host/reference/cavity.h"

namespace mica::host::reference::cavity_test {
namespace {

constexpr double kDegree = M_PI / 180;

Eigen::Vector3d direction(double polar, double azimuth) {
  return {std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), std::cos(polar)};
}

/// Facet on the disk that rises by `slope` over run.
Eigen::Vector2d facet(double slope, double azimuth) {
  return slope / std::sqrt(1 + slope * slope) * Eigen::Vector2d(std::cos(azimuth), std::sin(azimuth));
}

double gaussian(const Eigen::Vector2d& x, double sigma) {
  return std::exp(-0.5 * x.squaredNorm() / (sigma * sigma)) / (2 * M_PI * sigma * sigma);
}

/// f_1(o, i) max(i.g, 0) of one blurred cavity.
double single(const Eigen::Vector3d& o, const Eigen::Vector3d& i, const Eigen::Vector2d& p,
              double roughness) {
  const Eigen::Vector2d half = (o + i).normalized().head<2>();
  return mirrored(o, i, gaussian(half - p, roughness) + gaussian(half + p, roughness));
}

/// Integral of f_1(o, i) i.g over all lights: mirror images of the view in normals m on a grid of the disk,
/// with the solid angle of each, 4 (o.m) dm / m_z.
double integral(const Eigen::Vector3d& o, const Eigen::Vector2d& p, double roughness) {
  constexpr double reach = 6;  // roughnesses from the facet or its dual
  const double step = roughness / 20;
  const long last = std::lround((p.norm() + reach * roughness) / step);
  double sum = 0;
  for (long a = -last; a <= last; ++a) {
    for (long b = -last; b <= last; ++b) {
      const Eigen::Vector2d m = step * Eigen::Vector2d(static_cast<double>(a), static_cast<double>(b));
      const double squared = std::min((m - p).squaredNorm(), (m + p).squaredNorm());
      if (squared > reach * reach * roughness * roughness || m.squaredNorm() >= 1) continue;
      const Eigen::Vector3d normal(m.x(), m.y(), std::sqrt(1 - m.squaredNorm()));
      const double cosine = o.dot(normal);
      if (cosine <= 0) continue;
      const Eigen::Vector3d i = 2 * cosine * normal - o;
      sum += single(o, i, p, roughness) * 4 * cosine / normal.z() * step * step;
    }
  }
  return sum;
}

TEST(Cavity, HasTheEnergyOfItsGeometry) {
  // Seen from above, a facet of 30 degrees or less sends its light past its dual, one of 45 degrees sends it
  // straight into it; flat ones are mirrors.
  const Eigen::Vector3d above(0, 0, 1);
  EXPECT_NEAR(Cavity(facet(0, 0)).energy(direction(80 * kDegree, 1)), 1, 1e-12);
  EXPECT_NEAR(Cavity(facet(std::tan(29.9 * kDegree), 2)).energy(above), 1, 1e-12);
  EXPECT_NEAR(Cavity(facet(1.0, 2)).energy(above), 0, 1e-12);
  // At 40 degrees its image leaves at 80 degrees: the opening is 2 cos 80 cos 40 / cos 40 of the facet's
  // area.
  EXPECT_NEAR(Cavity(facet(std::tan(40 * kDegree), 2)).energy(above), 2 * std::cos(80 * kDegree), 1e-12);
  // Both sides are seen alike along the cavity, one alone across it from far down.
  EXPECT_NEAR(Cavity(facet(1, 0)).intersection_probability(direction(1, M_PI / 2)), 0.5, 1e-12);
  EXPECT_EQ(Cavity(facet(1, 0)).intersection_probability(direction(80 * kDegree, 0)), 1);
  EXPECT_EQ(Cavity(facet(1, 0)).masking(direction(80 * kDegree, M_PI)), 0);
}

/// [Che19] Eqs. 7 and 9: what leaves by one bounce is E_1, so with 1 - E_1 of the compensation all light
/// leaves.
TEST(Cavity, LocalFurnaceClosesForAllViewsAndNormals) {
  constexpr double roughness = 0.02;
  double worst = 0;
  for (const double polar : {0.0, 20.0, 45.0, 70.0, 80.0, 85.0, 89.0}) {
    for (const double slope : {0.0, 0.02, 0.1, 0.4, 0.8, 1.5, 3.0}) {
      for (const double azimuth : {0.0, 0.7, 1.5707, 2.9}) {
        const Eigen::Vector3d o = direction(polar * kDegree, 0);
        const Eigen::Vector2d p = facet(slope, azimuth);
        const double left = integral(o, p, roughness), energy = blurred_energy(o, p, roughness);
        EXPECT_NEAR(left, energy, 1e-3) << polar << " degrees, slope " << slope << " at " << azimuth;
        EXPECT_LE(energy, 1 + 1e-9);
        worst = std::max(worst, std::abs(left - energy));
      }
    }
  }
  std::printf("furnace within %.2g of 1\n", worst);
}

TEST(Cavity, IsSymmetric) {
  for (int n = 0; n < 1000; ++n) {
    const Eigen::Vector3d o = direction(1.57 * std::fmod(n * 0.618, 1), n),
                          i = direction(1.57 * std::fmod(n * 0.755, 1), 2.3 * n);
    const Eigen::Vector2d half = (o + i).normalized().head<2>();
    const Eigen::Vector2d p = half + Eigen::Vector2d(0.01, -0.02);
    const double forth = single(o, i, p, 0.02) / i.z(), back = single(i, o, p, 0.02) / o.z();
    ASSERT_GT(forth, 0);
    EXPECT_NEAR(back / forth, 1, 1e-5);
  }
}

/// A blur that hardly is one changes nothing where the energy has no kink.
TEST(Cavity, TendsToTheMirrorsEnergy) {
  for (const double polar : {10.0, 60.0, 85.0})
    for (const double slope : {0.05, 0.3, 0.7, 2.0})
      EXPECT_NEAR(blurred_energy(direction(polar * kDegree, 0.3), facet(slope, 1), 1e-4),
                  Cavity(facet(slope, 1)).energy(direction(polar * kDegree, 0.3)), 2e-3);
}

}  // namespace
}  // namespace mica::host::reference::cavity_test
