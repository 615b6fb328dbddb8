// The reference of `beckmanns`: its closed forms against integrals over the hemisphere.
#include "host/reference/beckmann_mixture.h"

#include <gtest/gtest.h>

#include <cmath>

#include "host/surface/surface.h"

namespace mica::host::reference::beckmann_mixture_test {
namespace {

Eigen::Vector3d direction(double polar, double azimuth) {
  return {std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), std::cos(polar)};
}

/// Integral of D(w) weight(w) over the hemisphere, by midpoints.
template <typename Weight>
double integrate(const std::vector<SlopeLobe>& lobes, Weight weight) {
  constexpr int rings = 100, sectors = 200;
  double sum = 0;
  for (int y = 0; y < rings; ++y) {
    const double low = 0.5 * M_PI * y / rings, high = 0.5 * M_PI * (y + 1) / rings;
    const double area = (std::cos(low) - std::cos(high)) * 2 * M_PI / sectors;
    for (int x = 0; x < sectors; ++x) {
      const Eigen::Vector3d w = direction(0.5 * (low + high), 2 * M_PI * (x + 0.5) / sectors);
      sum += area * weight(w) * BeckmannMixture::density(lobes, w.head<2>());
    }
  }
  return sum;
}

/// [Che18] Eq. 11: the projected area that a direction sees; and D is normalised as an NDF.
TEST(BeckmannMixture, VisibleAreaIsItsIntegral) {
  for (const double rms_slope : {0.3, 1.0}) {
    const Surface surface =
        make_surface({"test", SpectrumSurface{64, rms_slope, 6, 3}, Interpolation::bilinear}, nullptr);
    const BeckmannMixture mixture(surface, 1);
    Footprint footprint;
    footprint.mean_uv = {0.3, 0.6};
    footprint.cov_uv << 1, 0.3, 0.3, 0.5;
    footprint.cov_uv /= 64 * 64;
    const std::vector<SlopeLobe> lobes = mixture.lobes(footprint, 0.06);
    EXPECT_NEAR(integrate(lobes, [](const Eigen::Vector3d& w) { return w.z(); }), 1, 1e-3);
    for (const double degrees : {0.0, 30.0, 60.0, 75.0, 85.0}) {
      const Eigen::Vector3d o = direction(degrees * M_PI / 180, 0.9);
      const double expected =
          integrate(lobes, [&](const Eigen::Vector3d& w) { return std::max(o.dot(w), 0.0); });
      EXPECT_NEAR(BeckmannMixture::visible_area(lobes, o), expected, 1e-3 * expected)
          << "slope " << rms_slope << ", " << degrees << " degrees";
    }
  }
}

/// On a plane of slopes the moments of a lobe are those of its Gaussian kernel.
TEST(BeckmannMixture, LobesOfASmoothSlopeHaveItsKernelsVariance) {
  constexpr int size = 128;
  std::vector<Eigen::Vector2d> normals;
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < size; ++i) normals.emplace_back(0.005 * std::sin(2 * M_PI * i / size), 0.0);
  const BeckmannMixture mixture(Surface(size, size, Interpolation::bilinear, normals), 1);
  Footprint footprint;  // about texel 0, where the slope is steepest
  footprint.mean_uv = {0.0, 0.5};
  footprint.cov_uv *= 1e-8;
  const double slope = 0.005 * 2 * M_PI / size, kernel = 1 / (8 * std::log(2.0));
  for (const SlopeLobe& lobe : mixture.lobes(footprint, 1e-5)) {
    if (lobe.weight < 0.1) continue;
    EXPECT_NEAR(lobe.covariance(0, 0), slope * slope * kernel + 1e-10, 5e-3 * slope * slope * kernel);
    EXPECT_NEAR(lobe.covariance(1, 1), 1e-10, 1e-14);
  }
}

}  // namespace
}  // namespace mica::host::reference::beckmann_mixture_test
