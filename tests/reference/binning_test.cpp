#include "host/reference/binning.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <boost/math/distributions/chi_squared.hpp>
#include <numeric>

#include "host/base/random.h"
#include "host/reference/oracle.h"
#include "mica/error.h"

namespace mica::host::reference::binning_test {
namespace {

Surface random_surface(Interpolation interpolation) {
  std::vector<Eigen::Vector2d> normals(24 * 20);
  for (std::size_t k = 0; k < normals.size(); ++k) {
    normals[k] = {0.4 * random_unit(5, 0, k) - 0.2, 0.4 * random_unit(5, 1, k) - 0.1};
  }
  return Surface(24, 20, interpolation, std::move(normals));
}

Query tilted_query() {
  Query query;
  query.footprint.mean_uv = {7.95, -0.4};
  query.footprint.cov_uv << 0.004, 0.003, 0.003, 0.005;
  query.roughness = 0.03;
  return query;
}

std::uint64_t total(const BinnedNdf& ndf) {
  return std::accumulate(ndf.counts.begin(), ndf.counts.end(), ndf.outside_window + ndf.left_disk);
}

class Binning : public testing::TestWithParam<Interpolation> {};

TEST_P(Binning, AgreesWithTheOracleByChiSquare) {
  const Surface surface = random_surface(GetParam());
  const Query query = tilted_query();
  BinningSettings settings;
  settings.samples = 600'000;
  settings.bins = 16;
  settings.window_center = {0, 0.1};
  settings.window_radius = 0.3;
  const BinnedNdf ndf = bin_normals(surface, query, settings);
  EXPECT_EQ(total(ndf), settings.samples);

  // Simpson's weights turn the oracle's densities on the corners, edges and centres of the bins into their
  // integrals.
  const int side = 2 * settings.bins + 1;
  std::vector<Query> lattice(side * side, query);
  for (int k = 0; k < side * side; ++k) {
    const int i = k % side - 1, j = k / side - 1;
    lattice[k].half_vector = ndf.bin_center(0, 0) + 0.5 * ndf.bin_side() * Eigen::Vector2d(i, j);
  }
  const std::vector<OracleResult> density = Oracle(surface, 1e-6).evaluate(lattice);
  constexpr double simpson[3] = {1.0 / 6, 4.0 / 6, 1.0 / 6};
  double chi_squared = 0, rest_expected = 1, rest_counted = 1;
  int cells = 0;
  for (int j = 0; j < settings.bins; ++j) {
    for (int i = 0; i < settings.bins; ++i) {
      double probability = 0;
      for (int k = 0; k < 9; ++k) {
        probability +=
            simpson[k % 3] * simpson[k / 3] * density[(2 * j + k / 3) * side + 2 * i + k % 3].density;
      }
      probability *= ndf.bin_side() * ndf.bin_side();
      const double expected = probability * static_cast<double>(settings.samples);
      if (expected < 20) continue;  // too few for the test; they go to the rest
      const double counted =
          ndf.density(i, j) * ndf.bin_side() * ndf.bin_side() * static_cast<double>(settings.samples);
      chi_squared += (counted - expected) * (counted - expected) / expected;
      rest_expected -= probability;
      rest_counted -= counted / static_cast<double>(settings.samples);
      ++cells;
    }
  }
  ASSERT_GT(cells, 120);
  EXPECT_LT(rest_expected, 0.2);
  EXPECT_NEAR(rest_counted, rest_expected, 5 * std::sqrt(0.25 / static_cast<double>(settings.samples)));
  const double p = cdf(complement(boost::math::chi_squared(cells), chi_squared));
  EXPECT_GT(p, 1e-3) << chi_squared << " for " << cells << " bins";
  EXPECT_LT(p, 1 - 1e-3) << chi_squared << " for " << cells << " bins";
}

INSTANTIATE_TEST_SUITE_P(All, Binning,
                         testing::Values(Interpolation::nearest, Interpolation::bilinear,
                                         Interpolation::bicubic));

TEST(BinningCounts, WhatLeavesTheDiskAndTheWindow) {
  // A flat map at s = 0.9: the perturbed normals are a Gaussian, of which 0.9 < s^2 + t^2 is compared by
  // hand.
  const Surface surface(2, 2, Interpolation::bilinear,
                        std::vector<Eigen::Vector2d>(4, Eigen::Vector2d(0.9, 0)));
  Query query;
  query.roughness = 0.1;
  BinningSettings settings;
  settings.samples = 1'000'000;
  settings.bins = 7;
  settings.window_center = {0.9, 0};
  settings.window_radius = 0.05;
  const BinnedNdf ndf = bin_normals(surface, query, settings);
  EXPECT_EQ(total(ndf), settings.samples);
  const double inside = std::pow(std::erf(0.5 / std::sqrt(2.0)), 2) * 1e6;  // the window is half a deviation
  const double counted = 1e6 - static_cast<double>(ndf.outside_window + ndf.left_disk);
  EXPECT_NEAR(counted, inside, 5 * std::sqrt(inside));
  double left = 0;  // first what stays: exact in s, midpoints in t
  const int steps = 2000;
  for (int k = 0; k < steps; ++k) {
    const double t = -1 + 2 * (k + 0.5) / steps, reach = std::sqrt(1 - t * t);
    const double within = 0.5 * (std::erf((reach - 0.9) / 0.1 / std::sqrt(2.0)) -
                                 std::erf((-reach - 0.9) / 0.1 / std::sqrt(2.0)));
    left += within * std::exp(-0.5 * t * t / 0.01) / std::sqrt(2 * 3.14159265358979323846 * 0.01) * 2 / steps;
  }
  left = (1 - left) * 1e6;
  EXPECT_NEAR(static_cast<double>(ndf.left_disk), left, 5 * std::sqrt(left));
}

TEST(BinningCounts, AreTheSameForAnyNumberOfThreadsAndDifferForAnotherSeed) {
  const Surface surface = random_surface(Interpolation::bilinear);
  BinningSettings settings;
  settings.samples = 300'001;
  settings.bins = 16;
  const BinnedNdf parallel = bin_normals(surface, tilted_query(), settings);
  {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    EXPECT_EQ(bin_normals(surface, tilted_query(), settings).counts, parallel.counts);
  }
  settings.seed = 2;
  EXPECT_NE(bin_normals(surface, tilted_query(), settings).counts, parallel.counts);
}

TEST(BinningCounts, BadSettingsAreRefused) {
  const Surface surface = random_surface(Interpolation::bilinear);
  const auto refuses = [&](auto change) {
    BinningSettings settings;
    settings.samples = 1;
    change(&settings);
    EXPECT_THROW(bin_normals(surface, tilted_query(), settings), UsageError);
  };
  refuses([](BinningSettings* s) { s->bins = 0; });
  refuses([](BinningSettings* s) { s->bins = 1 << 20; });
  refuses([](BinningSettings* s) { s->samples = 0; });
  refuses([](BinningSettings* s) { s->window_radius = 0; });
  refuses([](BinningSettings* s) { s->window_radius = NAN; });
  Query flat = tilted_query();
  flat.footprint.cov_uv.setZero();
  EXPECT_THROW(bin_normals(surface, flat, BinningSettings{}), UsageError);
}

}  // namespace
}  // namespace mica::host::reference::binning_test
