// A disk as a sum of Gaussians, against the disk itself in the plane of frequencies [Parseval].
#include "host/scene/disk_cells.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "host/base/constants.h"

namespace mica::host::disk_cells_test {
namespace {

using Eigen::Vector2d;

/// Relative L2 between a uniform disk and its cells, both seen through a Gaussian lobe of standard
/// deviation 1.
double measured_error(double radius, int rings) {
  const double step = 0.5 / (radius + 4), end = 5;
  double square = 0, all = 0;
  for (double y = -end; y < end; y += step)
    for (double x = -end; x < end; x += step) {
      const Vector2d wave = radius * Vector2d(x, y);
      const double k = wave.norm(), lobe = std::exp(-0.5 * (x * x + y * y));
      const double disk = k < 1e-6 ? 1 : 2 * std::cyl_bessel_j(1, k) / k;
      std::complex<double> cells = 0;
      for (const DiskCell& cell : disk_cells(rings))
        cells +=
            cell.share * std::exp(-0.5 * wave.dot(cell.cov * wave)) * std::polar(1.0, -wave.dot(cell.mean));
      square += std::norm(lobe * (disk - cells)), all += lobe * lobe * disk * disk;
    }
  return std::sqrt(square / all);
}

TEST(DiskCells, HaveTheDisksMoments) {
  for (int rings = 0; rings <= kMostRings; ++rings) {
    SCOPED_TRACE(rings);
    double share = 0;
    Vector2d mean(0, 0);
    Eigen::Matrix2d second = Eigen::Matrix2d::Zero();
    for (const DiskCell& cell : disk_cells(rings)) {
      share += cell.share;
      mean += cell.share * cell.mean;
      second += cell.share * (cell.cov + cell.mean * cell.mean.transpose());
    }
    EXPECT_EQ(disk_cells(rings).size(), static_cast<std::size_t>(cells_of(rings)));
    EXPECT_NEAR(share, 1, 1e-12);
    EXPECT_NEAR(mean.norm(), 0, 1e-12);
    EXPECT_NEAR((second - 0.25 * Eigen::Matrix2d::Identity()).norm(), 0, 1e-12);
  }
}

TEST(DiskCells, AreAsFarFromTheDiskAsTheySay) {
  int compared = 0;
  for (int rings = 0; rings <= 4; ++rings)
    for (const double radius : {0.7, 1.0, 1.3, 2.0, 2.7, 3.5, 5.0, 7.0, 9.0}) {
      const double said = error_of_cells(radius, rings);
      if (said < 0.001 || said > 0.03) continue;
      SCOPED_TRACE(testing::Message() << rings << " rings, radius " << radius);
      const double measured = measured_error(radius, rings);
      EXPECT_LT(measured, 1.6 * said);
      EXPECT_GT(measured, 0.6 * said);
      ++compared;
    }
  EXPECT_GE(compared, 12);
}

TEST(DiskCells, AreAsManyAsATolerance) {
  EXPECT_EQ(LampParts::of(1, 0.01).rings(5), 0);
  EXPECT_EQ(LampParts::of(18, 0.01).most_rings, 1);
  EXPECT_EQ(LampParts::of(19, 0.01).most_rings, 2);
  EXPECT_EQ(LampParts::of(kMostLampParts, 0.01).most_rings, kMostRings);
  EXPECT_EQ(LampParts::of(19, 0.01).rings(0.5), 0) << "one Gaussian does";
  EXPECT_EQ(LampParts::of(19, 0.01).rings(2), 1);
  EXPECT_EQ(LampParts::of(19, 0.01).rings(4.5), 2);
  EXPECT_EQ(LampParts::of(19, 0.01).rings(50), 2) << "no more than may be";
  EXPECT_GT(LampParts::of(kMostLampParts, 1e-3).rings(4.5), 2);
}

}  // namespace
}  // namespace mica::host::disk_cells_test
