#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "host/surface/disk.h"
#include "host/surface/synthesis.h"
#include "mica/error.h"

namespace mica::host::spectrum_test {
namespace {

using Slopes = std::vector<Eigen::Vector2d>;

SpectrumSurface spectrum(int resolution, double rms_slope, double correlation_texels,
                         std::uint64_t seed = 1) {
  SpectrumSurface description;
  description.resolution = resolution;
  description.rms_slope = rms_slope;
  description.correlation_texels = correlation_texels;
  description.seed = seed;
  return description;
}

Slopes slopes_of(const SpectrumSurface& description) {
  SurfaceReport report;
  Slopes slopes = synthesise_spectrum(description, report);
  for (Eigen::Vector2d& s : slopes) s = slope_from_disk(s);
  return slopes;
}

double mean(const Slopes& slopes, const std::function<double(const Eigen::Vector2d&)>& quantity) {
  double sum = 0;
  for (const Eigen::Vector2d& slope : slopes) sum += quantity(slope);
  return sum / static_cast<double>(slopes.size());
}

TEST(Spectrum, HasTheRmsSlopeAskedFor) {
  for (const SpectrumSurface& description :
       {spectrum(512, 0.15, 8), spectrum(300, 1.5, 3), spectrum(257, 0.01, 20), spectrum(64, 0.3, 0.5),
        spectrum(4, 0.2, 1)}) {
    const Slopes slopes = slopes_of(description);
    const double rms =
        std::sqrt(mean(slopes, [](const Eigen::Vector2d& slope) { return slope.squaredNorm(); }));
    EXPECT_NEAR(rms / description.rms_slope, 1, 1e-9) << description.resolution;
  }
}

TEST(Spectrum, IsIsotropicGaussianAndOfZeroMean) {
  const Slopes slopes = slopes_of(spectrum(1024, 0.2, 6));
  const double variance = 0.02;  // an axis
  EXPECT_NEAR(mean(slopes, [](const auto& slope) { return slope.x() * slope.x(); }) / variance, 1, 0.02);
  EXPECT_NEAR(mean(slopes, [](const auto& slope) { return slope.x() * slope.y(); }) / variance, 0, 0.02);
  EXPECT_NEAR(mean(slopes, [](const auto& slope) { return slope.x(); }), 0, 1e-12);
  EXPECT_NEAR(mean(slopes, [](const auto& slope) { return slope.y(); }), 0, 1e-12);
  EXPECT_NEAR(mean(slopes, [](const auto& slope) { return std::pow(slope.x(), 4); }) / (variance * variance),
              3, 0.15);
  EXPECT_NEAR(
      mean(slopes, [](const auto& slope) { return std::pow(slope.y(), 3); }) / std::pow(variance, 1.5), 0,
      0.06);
}

TEST(Spectrum, HasTheCorrelationAskedFor) {
  // For heights of autocorrelation exp(-(d/c)^2), that of p is the same along v, and (1 - 2 (d/c)^2) times it
  // along u.
  const int size = 1024;
  const double c = 8;
  const Slopes slopes = slopes_of(spectrum(size, 0.15, c));
  const auto correlation = [&](int component, int along_u, int along_v) {
    double sum = 0, squares = 0;
    for (int j = 0; j < size; ++j) {
      for (int i = 0; i < size; ++i) {
        const double here = slopes[static_cast<std::size_t>(j) * size + i][component];
        sum +=
            here *
            slopes[static_cast<std::size_t>((j + along_v) % size) * size + (i + along_u) % size][component];
        squares += here * here;
      }
    }
    return sum / squares;
  };
  for (const int d : {2, 5, 8, 12, 16, 40}) {
    const double x = d / c, across = std::exp(-x * x), along = (1 - 2 * x * x) * across;
    EXPECT_NEAR(correlation(0, 0, d), across, 0.02) << d;
    EXPECT_NEAR(correlation(1, d, 0), across, 0.02) << d;
    EXPECT_NEAR(correlation(0, d, 0), along, 0.02) << d;
    EXPECT_NEAR(correlation(1, 0, d), along, 0.02) << d;
  }
  // The distance of 1/e, between texels: the autocorrelation there falls by 2/e a correlation length.
  const double distance = c + c * (correlation(0, 0, 8) - std::exp(-1.0)) / (2 * std::exp(-1.0));
  EXPECT_NEAR(distance / c, 1, 0.05);
}

TEST(Spectrum, IsTheGradientOfAHeightfield) {
  const int size = 256;
  const Slopes slopes = slopes_of(spectrum(size, 0.5, 16));
  const auto at = [&](int i, int j) { return slopes[static_cast<std::size_t>(j % size) * size + i % size]; };
  // Simpson's rule: height differences over two texels must not depend on the way taken.
  const auto rise_u = [&](int i, int j) {
    return (at(i, j).x() + 4 * at(i + 1, j).x() + at(i + 2, j).x()) / 3;
  };
  const auto rise_v = [&](int i, int j) {
    return (at(i, j).y() + 4 * at(i, j + 1).y() + at(i, j + 2).y()) / 3;
  };
  const int side = 20;
  for (int corner = 0; corner < size; corner += 7) {
    double first_u = 0, first_v = 0;
    for (int step = 0; step < side; step += 2) {
      first_u += rise_u(corner + step, corner) + rise_v(corner + side, corner + step);
      first_v += rise_v(corner, corner + step) + rise_u(corner + step, corner + side);
    }
    EXPECT_NEAR(first_u, first_v, 1e-4) << corner;
  }
}

TEST(Spectrum, ReturnsToTheSameHeightAroundEveryPeriod) {
  for (const int size : {8, 9}) {
    const Slopes slopes = slopes_of(spectrum(size, 0.5, 0.5));  // all modes of the grid, up to the finest
    for (int line = 0; line < size; ++line) {
      double along_u = 0, along_v = 0;
      for (int k = 0; k < size; ++k) {
        along_u += slopes[line * size + k].x();
        along_v += slopes[k * size + line].y();
      }
      EXPECT_NEAR(along_u, 0, 1e-12);
      EXPECT_NEAR(along_v, 0, 1e-12);
    }
  }
}

TEST(Spectrum, HasNoSeam) {
  const int size = 256;
  const Slopes slopes = slopes_of(spectrum(size, 0.15, 4));
  std::vector<double> columns,
      rows;  // mean squared change from column (row) k to the next, around the seam at the last
  for (int k = 0; k < size; ++k) {
    double column = 0, row = 0;
    for (int l = 0; l < size; ++l) {
      column += (slopes[l * size + k] - slopes[l * size + (k + 1) % size]).squaredNorm();
      row += (slopes[k * size + l] - slopes[(k + 1) % size * size + l]).squaredNorm();
    }
    columns.push_back(column);
    rows.push_back(row);
  }
  for (const std::vector<double>& changes : {columns, rows}) {
    const double seam = changes.back();
    EXPECT_GE(seam, *std::min_element(changes.begin(), changes.end() - 1));
    EXPECT_LE(seam, *std::max_element(changes.begin(), changes.end() - 1));
  }
}

TEST(Spectrum, DoesNotDependOnTheNumberOfThreads) {
  const auto normals = [](std::size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    SurfaceReport report;
    return synthesise_spectrum(spectrum(200, 0.15, 5), report);
  };
  const std::vector<Eigen::Vector2d> alone = normals(1);
  EXPECT_EQ(alone, normals(2));
  EXPECT_EQ(alone, normals(7));
}

TEST(Spectrum, KeepsItsShapesAtTwiceTheResolution) {
  const Slopes coarse = slopes_of(spectrum(64, 0.2, 6)), fine = slopes_of(spectrum(128, 0.2, 12));
  for (int j = 0; j < 64; ++j) {
    for (int i = 0; i < 64; ++i) EXPECT_LT((coarse[j * 64 + i] - fine[2 * j * 128 + 2 * i]).norm(), 1e-9);
  }
}

TEST(Spectrum, ChangesWithTheSeedAndIsFlatWithoutSlope) {
  EXPECT_NE(slopes_of(spectrum(32, 0.15, 4, 1)), slopes_of(spectrum(32, 0.15, 4, 2)));
  for (const Eigen::Vector2d& slope : slopes_of(spectrum(32, 0, 4))) EXPECT_EQ(slope, Eigen::Vector2d(0, 0));
}

TEST(Spectrum, RefusesSettingsOutOfRange) {
  const double nan = std::nan("");
  for (const SpectrumSurface& description :
       {spectrum(3, 0.1, 2), spectrum(16385, 0.1, 2), spectrum(-1, 0.1, 2), spectrum(64, -0.1, 2),
        spectrum(64, nan, 2), spectrum(64, 5.1, 2), spectrum(64, 0.1, 0), spectrum(64, 0.1, nan),
        spectrum(64, 0.1, 65)}) {
    EXPECT_THROW(slopes_of(description), UsageError);
  }
}

TEST(Spectrum, WarnsOfCorrelationsThatTheGridBends) {
  for (const double correlation : {1.5, 20.0}) {
    SurfaceReport report;
    synthesise_spectrum(spectrum(64, 0.1, correlation), report);
    EXPECT_EQ(report.warnings.size(), 1u) << correlation;
  }
  SurfaceReport report;
  synthesise_spectrum(spectrum(64, 0.1, 8), report);
  EXPECT_TRUE(report.warnings.empty());
}

}  // namespace
}  // namespace mica::host::spectrum_test
