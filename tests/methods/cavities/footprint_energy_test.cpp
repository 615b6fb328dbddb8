// Moments of slopes under footprints against plain weighted sums over the texels, and that the energy they
// lose is no more than what the texels lose.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "host/methods/cavities/footprint_energy.h"
#include "host/surface/disk.h"

namespace mica::host::footprint_energy_test {
namespace {

Surface bumps() {
  SpectrumSurface spectrum;
  spectrum.resolution = 256;
  spectrum.rms_slope = 0.4;
  return make_surface({"bumps", spectrum, Interpolation::bilinear}, nullptr);
}

/// A Gaussian surface with one roughness is what the table is made for.
TEST(FootprintEnergy, IsTheTableOnGaussianSurfaces) {
  const FootprintEnergy energy(bumps());
  for (const double degrees : {0.0, 30.0, 60.0, 75.0}) {
    const double polar = degrees * M_PI / 180;
    const ViewQuery whole{
        {{0.5, 0.5}, Eigen::Matrix2d::Identity()}, {std::sin(polar), 0, std::cos(polar)}, 1e-5};
    const double lost = 1 - mean_cavity_energy(0.4, std::cos(polar));  // alpha^2 = E[p^2 + q^2]
    EXPECT_LE(energy.lost(whole), lost + 2e-3) << degrees;
    EXPECT_GE(energy.lost(whole), 0.7 * lost) << degrees;
  }
}

TEST(FootprintEnergy, LosesNothingOnPlanes) {
  const Surface plane(64, 48, Interpolation::bilinear,
                      std::vector<Eigen::Vector2d>(64 * 48, disk_from_slope({0.3, -0.2})));
  EXPECT_NEAR(FootprintEnergy(plane).lost({{}, Eigen::Vector3d::UnitZ(), 1e-5}), 0, 1e-6);
}

/// However steep: only how much slopes differ counts.
TEST(FootprintEnergy, LosesOnSteepPlanesWhatItLosesOnFlatOnes) {
  const auto lost = [](const Eigen::Vector2d& slope) {
    const Surface plane(64, 48, Interpolation::bilinear,
                        std::vector<Eigen::Vector2d>(64 * 48, disk_from_slope(slope)));
    return FootprintEnergy(plane).lost({{}, Eigen::Vector3d(0.99995, 0, 0.01), 1e-5});
  };
  EXPECT_NEAR(lost({9.7, -7.3}), lost({0, 0}), 1e-7);
}

TEST(FootprintEnergy, StaysSmallAndSaysSo) {
  for (const int size : {4, 37, 256}) {
    const Surface surface(size, 4, Interpolation::bilinear, std::vector<Eigen::Vector2d>(size * 4, {0.1, 0}));
    EXPECT_EQ(FootprintEnergy(surface).bytes(), footprint_energy_bytes(size, 4));
  }
  EXPECT_LE(footprint_energy_bytes(2048, 2048), std::size_t{13} << 20);
}

TEST(FootprintEnergy, StandsVerticalFacets) {
  std::vector<Eigen::Vector2d> normals(32 * 32, Eigen::Vector2d::Zero());
  for (int n = 0; n < 32 * 32; n += 7) normals[n] = {0.99999, 0};
  const FootprintEnergy energy(Surface(32, 32, Interpolation::nearest, normals));
  for (const double cosine : {1.0, 0.1, 1e-9}) {
    const ViewQuery view{
        {{0.2, 0.2}, Eigen::Matrix2d::Identity() * 0.01}, {std::sqrt(1 - cosine * cosine), 0, cosine}, 0.02};
    EXPECT_GE(energy.lost(view), 0);
    EXPECT_LE(energy.lost(view), 1);
  }
}

/// Where slopes are no Gaussian, [Che19] Eq. 18 alone would lose more than the texels do.
TEST(FootprintEnergy, LosesNoMoreThanTheTexels) {
  ScratchesSurface scratches;
  scratches.resolution = 128;
  scratches.length_texels = 60;
  scratches.density = 1;
  scratches.depth_texels = 2.5;
  const Surface surface = make_surface({"scratches", scratches, Interpolation::bilinear}, nullptr);
  const FootprintEnergy energy(surface);
  const ViewQuery whole{{{0.5, 0.5}, Eigen::Matrix2d::Identity()}, Eigen::Vector3d::UnitZ(), 1e-5};
  double lost = 0, squared_slope = 0;
  for (const Eigen::Vector2d& n : surface.normals()) {
    // From above a facet and its dual are seen alike, and one lets go what lies within the opening.
    const double squared_cosine = 1 - n.squaredNorm();
    lost += 1 - std::clamp(4 * squared_cosine - 2, 0.0, 1.0);
    squared_slope += slope_from_disk(n).squaredNorm();
  }
  lost /= static_cast<double>(surface.normals().size());
  squared_slope /= static_cast<double>(surface.normals().size());
  EXPECT_LE(energy.lost(whole), lost);
  EXPECT_GE(energy.lost(whole), 0.8 * lost);
  EXPECT_GT(1 - mean_cavity_energy(std::sqrt(squared_slope), 1), lost + 0.05);  // the Gaussian
}

}  // namespace
}  // namespace mica::host::footprint_energy_test
