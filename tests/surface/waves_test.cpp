#include <complex>

#include "host/base/constants.h"
#include "mica/error.h"
#include "tests/surface/map_statistics.h"

namespace mica::host::waves_test {
namespace {

WavesSurface waves(int resolution = 128, double patch_meters = 200, double time_seconds = 0) {
  WavesSurface description;
  description.resolution = resolution;
  description.patch_meters = patch_meters;
  description.wind_speed = 6;
  description.wind_direction_degrees = 25;
  description.time_seconds = time_seconds;
  return description;
}

std::vector<Eigen::Vector2d> normals(const WavesSurface& description) {
  SurfaceReport report;
  return synthesise_waves(description, report);
}

/// Fourier coefficient of the heights, metres, of the mode with m and n periods, from its slope along k.
std::complex<double> height_mode(const Slopes& slopes, const WavesSurface& description, int m, int n) {
  const int size = description.resolution;
  const Eigen::Vector2d k = 2 * kPi / description.patch_meters * Eigen::Vector2d(m, n);
  std::complex<double> sum = 0;
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < size; ++i)
      sum += k.normalized().dot(slopes[j * size + i]) *
             std::polar(1.0, -2 * kPi * (m * i + n * j) / static_cast<double>(size));
  return sum / (std::complex<double>(0, k.norm()) * static_cast<double>(size * size));
}

/// Variance of the heights, m^2: the sum of their modes' squares, by a discrete Fourier transform of each
/// axis in turn.
double height_variance(const Slopes& slopes, const WavesSurface& description) {
  const int size = description.resolution;
  using Matrix = Eigen::MatrixXcd;
  Matrix transform(size, size), p(size, size), q(size, size);
  for (int a = 0; a < size; ++a) {
    for (int b = 0; b < size; ++b) {
      transform(a, b) = std::polar(1.0 / size, -2 * kPi * (a * b % size) / size);
      p(b, a) = slopes[b * size + a].x(), q(b, a) = slopes[b * size + a].y();
    }
  }
  const Matrix p_modes = transform * p * transform, q_modes = transform * q * transform;
  double variance = 0;
  for (int row = 0; row < size; ++row) {
    for (int column = 0; column < size; ++column) {
      const int m = column > size / 2 ? column - size : column, n = row > size / 2 ? row - size : row;
      const double k = 2 * kPi / description.patch_meters * std::hypot(m, n);
      if (k > 0) variance += (std::norm(p_modes(row, column)) + std::norm(q_modes(row, column))) / (k * k);
    }
  }
  return variance;
}

TEST(Waves, HaveTheHeightVarianceOfTheSpectrumsIntegral) {
  // The peak is at 5 waves over the patch; of those above 63 the sea's variance holds 0.8%.
  const WavesSurface description = waves(128, 150);
  const double expected = 8.1e-3 * std::pow(6.0, 4) / (4 * 0.74 * 9.81 * 9.81);
  EXPECT_DOUBLE_EQ(wave_height_variance(6), expected);
  EXPECT_NEAR(height_variance(slopes_of(normals(description)), description) / expected, 1, 0.02);
}

TEST(Waves, SpectrumIntegratesToTheVariance) {
  // Over frequency and direction, by the midpoint rule; d k = 2 omega / g k d omega d theta.
  const WavesSurface description = waves();
  const int steps = 400;
  double sum = 0;
  for (int a = 0; a < steps; ++a) {
    const double theta = 2 * kPi * (a + 0.5) / steps;
    for (int b = 0; b < 4 * steps; ++b) {
      const double omega = 40.0 * (b + 0.5) / (4 * steps), k = omega * omega / 9.81;
      const Eigen::Vector2d wave_vector = k * Eigen::Vector2d(std::cos(theta), std::sin(theta));
      sum += wave_spectrum(description, wave_vector) * k * 2 * omega / 9.81 * (40.0 / (4 * steps)) *
             (2 * kPi / steps);
    }
  }
  EXPECT_NEAR(sum / wave_height_variance(6), 1, 1e-3);
}

TEST(Waves, HaveTheRmsSlopeOfTheSpectrum) {
  const WavesSurface description = waves(256);
  const double unit = 2 * kPi / description.patch_meters;
  double expected = 0;  // sum of k^2 times the spectrum over the grid's modes
  for (int m = -127; m <= 127; ++m)
    for (int n = -127; n <= 127; ++n) {
      const Eigen::Vector2d k = unit * Eigen::Vector2d(m, n);
      if (m != 0 || n != 0) expected += k.squaredNorm() * wave_spectrum(description, k) * unit * unit;
    }
  EXPECT_NEAR(std::sqrt(mean_square(slopes_of(normals(description))) / expected), 1, 1e-9);
}

TEST(Waves, ModesTurnByTheDispersionRelation) {
  const double seconds = 3.7;
  const WavesSurface start = waves(), later = waves(128, 200, seconds);
  const Slopes before = slopes_of(normals(start)), after = slopes_of(normals(later));
  for (const auto& [m, n] : {std::pair(5, 2), std::pair(9, -1), std::pair(3, 14), std::pair(30, 20)}) {
    const double omega = std::sqrt(9.81 * 2 * kPi / 200 * std::hypot(m, n));
    const std::complex<double> was = height_mode(before, start, m, n), is = height_mode(after, later, m, n);
    const std::complex<double> expected = was * std::polar(1.0, -omega * seconds);  // m, n runs downwind
    EXPECT_LT(std::abs(is - expected), 1e-9 * std::abs(was)) << m << ", " << n;
  }
  EXPECT_LT(std::abs(height_mode(before, start, -1, 6) - std::conj(height_mode(before, start, 1, -6))),
            1e-12);
}

// What a coarse map lacks is short waves: of slopes with the variance of the spectrum's tail, alpha / (2 k)
// dk, in which alpha = 8.1e-3 [Pierson, Moskowitz 1964].
TEST(Waves, AreTheSameOnACoarserGridButForTheShortest) {
  const WavesSurface coarse = waves(64, 100), fine = waves(256, 100);
  const Slopes few = slopes_of(normals(coarse)), many = slopes_of(normals(fine));
  for (const auto& [m, n] : {std::pair(5, 2), std::pair(9, -1), std::pair(3, 14), std::pair(20, 10)}) {
    const std::complex<double> mode = height_mode(many, fine, m, n);
    EXPECT_LT(std::abs(height_mode(few, coarse, m, n) - mode), 1e-9 * std::abs(mode)) << m << ", " << n;
  }
  EXPECT_NEAR((mean_square(many) - mean_square(few)) / (8.1e-3 / 2 * std::log(4.0)), 1, 0.02);
}

TEST(Waves, KeepTheirEnergyAndReturnToTheirStart) {
  const double start = mean_square(slopes_of(normals(waves())));
  for (const double seconds : {-20.0, 0.1, 1000.0})
    EXPECT_NEAR(mean_square(slopes_of(normals(waves(128, 200, seconds)))) / start, 1, 1e-9);
  EXPECT_NE(normals(waves(128, 200, 0.1)), normals(waves()));
  EXPECT_EQ(normals(waves(128, 200, -0.0)), normals(waves()));
}

TEST(Waves, RunDownwind) {
  // Slopes are steepest along the wind: cos^2 spreading gives 3/4 of the mean square there.
  double along = 0, across = 0;
  const Eigen::Vector2d wind(std::cos(25 * kPi / 180), std::sin(25 * kPi / 180));
  for (const Eigen::Vector2d& slope : slopes_of(normals(waves(256)))) {
    along += std::pow(wind.dot(slope), 2);
    across += std::pow(wind.x() * slope.y() - wind.y() * slope.x(), 2);
  }
  EXPECT_NEAR(along / (along + across), 0.75, 0.02);
}

TEST(Waves, HaveNoSeamAndNeedNoCertainThreads) {
  expect_no_seam(slopes_of(normals(waves(256, 200, 5))), 256);
  expect_same_on_any_threads([] { return normals(waves(150, 200, 2)); });
}

TEST(Waves, WarnOfSmallPatchesAndRefuseSettingsOutOfRange) {
  SurfaceReport report;
  synthesise_waves(waves(64, 20), report);
  EXPECT_EQ(report.warnings.size(), 1u);
  for (double WavesSurface::*setting : {&WavesSurface::patch_meters, &WavesSurface::wind_speed,
                                        &WavesSurface::wind_direction_degrees, &WavesSurface::time_seconds}) {
    for (const double value : {std::nan(""), -1e7, 1e7}) {
      WavesSurface description = waves();
      description.*setting = value;
      EXPECT_THROW(normals(description), UsageError) << value;
    }
  }
}

}  // namespace
}  // namespace mica::host::waves_test
