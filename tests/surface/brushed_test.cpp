#include "mica/error.h"
#include "tests/surface/map_statistics.h"

namespace mica::host::brushed_test {
namespace {

BrushedSurface brushed(int resolution, double along, double across, double degrees = 0) {
  BrushedSurface description;
  description.resolution = resolution;
  description.rms_slope = 0.2;
  description.correlation_along_texels = along;
  description.correlation_across_texels = across;
  description.direction_degrees = degrees;
  return description;
}

std::vector<Eigen::Vector2d> normals(const BrushedSurface& description) {
  SurfaceReport report;
  return synthesise_brushed(description, report);
}

/// Distance at which a correlation that falls by 2/e a correlation length near there is 1/e.
double length_of(double length, double correlation) {
  return length + length * (correlation - std::exp(-1.0)) / (2 * std::exp(-1.0));
}

TEST(Brushed, HasTheRmsSlopeAskedFor) {
  for (const BrushedSurface& description : {brushed(256, 40, 3), brushed(300, 30, 2, 37), brushed(128, 4, 4)})
    EXPECT_NEAR(std::sqrt(mean_square(slopes_of(normals(description)))) / 0.2, 1, 1e-9);
}

TEST(Brushed, HasTheCorrelationsAskedFor) {
  // Heights correlate as exp(-(a/ca)^2 - (b/cb)^2). So does the slope across the brushing, along it; and the
  // slope along the brushing, across it.
  const int size = 1024, along = 24, across = 6;
  const Slopes slopes = slopes_of(normals(brushed(size, along, across)));
  EXPECT_NEAR(length_of(along, autocorrelation(slopes, size, 1, along, 0)) / along, 1, 0.05);
  EXPECT_NEAR(length_of(across, autocorrelation(slopes, size, 0, 0, across)) / across, 1, 0.05);
  const Slopes upright = slopes_of(normals(brushed(size, along, across, 90)));
  EXPECT_NEAR(length_of(along, autocorrelation(upright, size, 0, 0, along)) / along, 1, 0.05);
  EXPECT_NEAR(length_of(across, autocorrelation(upright, size, 1, across, 0)) / across, 1, 0.05);
}

TEST(Brushed, SlopesAreSteepAcrossTheDirection) {
  // E[p^2] of an autocorrelation exp(-(d/c)^2) is 2 / c^2 of the height's variance.
  const double degrees = 30, along = 40, across = 5;
  const Eigen::Vector2d axis(std::cos(degrees * M_PI / 180), std::sin(degrees * M_PI / 180));
  double a = 0, b = 0, ab = 0;
  for (const Eigen::Vector2d& slope : slopes_of(normals(brushed(1024, along, across, degrees)))) {
    const double p = axis.dot(slope), q = axis.x() * slope.y() - axis.y() * slope.x();
    a += p * p, b += q * q, ab += p * q;
  }
  EXPECT_NEAR(a / b / std::pow(across / along, 2), 1, 0.05);
  EXPECT_NEAR(ab / std::sqrt(a * b), 0, 0.02);
}

TEST(Brushed, EqualsTheSpectrumWhenRound) {
  SpectrumSurface spectrum;
  spectrum.resolution = 64, spectrum.rms_slope = 0.2, spectrum.correlation_texels = 5;
  SurfaceReport report;
  const auto expected = synthesise_spectrum(spectrum, report), round = normals(brushed(64, 5, 5, 20));
  for (std::size_t n = 0; n < expected.size(); ++n) ASSERT_LT((expected[n] - round[n]).norm(), 1e-12);
}

TEST(Brushed, HasNoSeamAndNeedsNoCertainThreads) {
  expect_no_seam(slopes_of(normals(brushed(256, 40, 3, 20))), 256);
  expect_same_on_any_threads([] { return normals(brushed(130, 20, 3, 20)); });
}

TEST(Brushed, RefusesSettingsOutOfRangeAndWarns) {
  const double nan = std::nan("");
  for (const BrushedSurface& description :
       {brushed(3, 2, 2), brushed(64, 65, 2), brushed(64, 8, 0), brushed(64, nan, 2), brushed(64, 8, 2, 361)})
    EXPECT_THROW(normals(description), UsageError);
  SurfaceReport report;
  synthesise_brushed(brushed(64, 30, 1), report);
  EXPECT_EQ(report.warnings.size(), 2u);
}

}  // namespace
}  // namespace mica::host::brushed_test
