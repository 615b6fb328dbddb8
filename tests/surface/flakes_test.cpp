#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <set>
#include <utility>

#include "host/surface/disk.h"
#include "host/surface/synthesis.h"
#include "mica/error.h"

namespace mica::host::flakes_test {
namespace {

FlakesSurface flakes(int resolution, double flake_size_texels, double alpha, std::uint64_t seed = 1) {
  FlakesSurface description;
  description.resolution = resolution;
  description.flake_size_texels = flake_size_texels;
  description.alpha = alpha;
  description.seed = seed;
  return description;
}

Flakes make(const FlakesSurface& description) {
  SurfaceReport report;
  return synthesise_flakes(description, report);
}

/// The shortest way from a to b on the torus.
Eigen::Vector2d way(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double period) {
  const Eigen::Array2d d = (b - a).array();
  return d - period * (d / period).round();
}

/// Pairs of flakes that share a border of the map's texels.
std::set<std::pair<std::uint32_t, std::uint32_t>> neighbours(const Flakes& flakes, int size) {
  const auto flake = [&](int i, int j) {
    return flakes.flake_of_texel[static_cast<std::size_t>(j % size) * size + i % size];
  };
  std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (int j = 0; j < size; ++j) {
    for (int i = 0; i < size; ++i) {
      for (const std::uint32_t other : {flake(i + 1, j), flake(i, j + 1)}) {
        if (other != flake(i, j)) pairs.insert(std::minmax(other, flake(i, j)));
      }
    }
  }
  return pairs;
}

TEST(Flakes, BelongToTheNearestCentreAroundTheTorus) {
  const int size = 64;
  const Flakes result = make(flakes(size, 9, 0.2));
  for (int j = 0; j < size; ++j) {
    for (int i = 0; i < size; ++i) {
      const Eigen::Vector2d position(i + 0.5, j + 0.5);
      const auto nearest = std::min_element(
          result.centers_texels.begin(), result.centers_texels.end(), [&](const auto& a, const auto& b) {
            return way(position, a, size).squaredNorm() < way(position, b, size).squaredNorm();
          });
      ASSERT_EQ(result.flake_of_texel[j * size + i], nearest - result.centers_texels.begin())
          << i << ", " << j;
    }
  }
}

TEST(Flakes, KeepTheirDistance) {
  const int size = 512;
  const double flake_size = 10;
  const Flakes result = make(flakes(size, flake_size, 0.2));
  double least = size, sum = 0;
  std::complex<double> two_fold = 0, four_fold = 0;  // zero when neighbours lie in all directions alike
  const auto pairs = neighbours(result, size);
  for (const auto& [a, b] : pairs) {
    const Eigen::Vector2d d = way(result.centers_texels[a], result.centers_texels[b], size);
    const std::complex<double> direction(d.x() / d.norm(), d.y() / d.norm());
    least = std::min(least, d.norm());
    sum += d.norm();
    two_fold += std::pow(direction, 2);
    four_fold += std::pow(direction, 4);
  }
  const auto count = static_cast<double>(pairs.size());
  EXPECT_NEAR(sum / count / flake_size, 1, 0.01);
  EXPECT_GT(least, 0.7 * flake_size);  // Poisson disk: random points would come arbitrarily close
  EXPECT_LT(std::abs(two_fold) / count, 4 / std::sqrt(count));
  EXPECT_LT(std::abs(four_fold) / count, 4 / std::sqrt(count));
}

TEST(Flakes, CoverThePlaneEvenly) {
  const int size = 300;
  const double flake_size = 6;
  const Flakes result = make(flakes(size, flake_size, 0.2));
  // Between the densest packing of this mean distance and a set with room for as many again.
  const auto count = static_cast<double>(result.normals.size());
  EXPECT_LT(count, 2 / std::sqrt(3.0) * std::pow(size / flake_size, 2) * 1.1);
  EXPECT_GT(count, 1.1 * std::pow(size / flake_size, 2));
  // No texel is farther from its centre than a dart's throw that would still have fitted, or little more.
  double farthest = 0;
  std::set<std::uint32_t> seen;
  for (int texel = 0; texel < size * size; ++texel) {
    const Eigen::Vector2d position(texel % size + 0.5, texel / size + 0.5);
    const std::uint32_t flake = result.flake_of_texel[texel];
    farthest = std::max(farthest, way(position, result.centers_texels[flake], size).norm());
    seen.insert(flake);
  }
  EXPECT_LT(farthest, flake_size);
  EXPECT_EQ(seen.size(), result.normals.size());
}

TEST(Flakes, HaveOneNormalEach) {
  const Flakes result = make(flakes(128, 8, 0.2));
  const std::vector<Eigen::Vector2d> texels = result.texel_normals();
  ASSERT_EQ(texels.size(), 128u * 128u);
  for (std::size_t texel = 0; texel < texels.size(); ++texel) {
    ASSERT_EQ(texels[texel], result.normals[result.flake_of_texel[texel]]);
  }
  std::set<double> different;
  for (const Eigen::Vector2d& normal : result.normals) different.insert(normal.x());
  EXPECT_EQ(different.size(), result.normals.size());
}

TEST(Flakes, HaveGaussianSlopes) {
  const double alpha = 0.3;
  const Flakes result = make(flakes(512, 3, alpha));
  double uu = 0, uv = 0, vv = 0;
  for (const Eigen::Vector2d& normal : result.normals) {
    const Eigen::Vector2d slope = slope_from_disk(normal);
    uu += slope.x() * slope.x();
    uv += slope.x() * slope.y();
    vv += slope.y() * slope.y();
  }
  const auto count = static_cast<double>(result.normals.size());
  const double variance = alpha * alpha / 2, four_sigma = 4 * std::sqrt(2 / count);
  ASSERT_GT(count, 30000);
  EXPECT_NEAR(uu / count / variance, 1, four_sigma);
  EXPECT_NEAR(vv / count / variance, 1, four_sigma);
  EXPECT_NEAR(uv / count / variance, 0, four_sigma);
}

TEST(Flakes, HaveBeckmannsDensityOnTheDisk) {
  // D = exp(-tan^2 / alpha^2) / (pi alpha^2 cos^4), integrated over rings of the disk: chi-square against the
  // counts.
  const double alpha = 0.7;
  const Flakes result = make(flakes(512, 3, alpha));
  const int rings = 20;
  std::vector<double> counts(rings, 0.0), expected(rings, 0.0);
  for (const Eigen::Vector2d& normal : result.normals) counts[static_cast<int>(rings * normal.norm())] += 1;
  const int steps = 1000;
  double whole = 0;
  for (int ring = 0; ring < rings; ++ring) {
    for (int step = 0; step < steps; ++step) {
      const double r = (ring + (step + 0.5) / steps) / rings, cos2 = 1 - r * r, tan2 = r * r / cos2;
      const double density = std::exp(-tan2 / (alpha * alpha)) / (M_PI * alpha * alpha * cos2 * cos2);
      expected[ring] += density * 2 * M_PI * r / (rings * steps) * static_cast<double>(result.normals.size());
    }
    whole += expected[ring];
  }
  EXPECT_NEAR(whole / static_cast<double>(result.normals.size()), 1, 1e-5);
  double chi2 = 0;
  for (int ring = 0; ring < rings; ++ring)
    chi2 += std::pow(counts[ring] - expected[ring], 2) / (expected[ring] + 1e-9);
  EXPECT_LT(chi2, 45.3);  // 19 degrees of freedom, p = 0.0006
}

TEST(Flakes, DoNotDependOnTheNumberOfThreads) {
  const auto with = [](std::size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    return make(flakes(200, 5, 0.2)).texel_normals();
  };
  const std::vector<Eigen::Vector2d> alone = with(1);
  EXPECT_EQ(alone, with(2));
  EXPECT_EQ(alone, with(7));
  EXPECT_NE(alone, make(flakes(200, 5, 0.2, 2)).texel_normals());
}

TEST(Flakes, RefuseSettingsOutOfRange) {
  const double nan = std::nan("");
  for (const FlakesSurface& description :
       {flakes(7, 2, 0.2), flakes(16385, 9, 0.2), flakes(64, 1.9, 0.2), flakes(64, 16.1, 0.2),
        flakes(64, nan, 0.2), flakes(64, 8, -0.1), flakes(64, 8, 2.1), flakes(64, 8, nan)}) {
    EXPECT_THROW(make(description), UsageError);
  }
  EXPECT_NO_THROW(make(flakes(8, 2, 2)));
  const Flakes flat = make(flakes(64, 16, 0));
  for (const Eigen::Vector2d& normal : flat.normals) EXPECT_EQ(normal, Eigen::Vector2d(0, 0));
}

}  // namespace
}  // namespace mica::host::flakes_test
