// `grid` against its definition in double precision, against closed forms, and against what it promises on
// average. [Kem25]
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

#include "host/engine/grid_evaluator.h"
#include "host/reference/glint_grid.h"
#include "host/surface/random.h"

namespace mica {
namespace {

constexpr double kPi = 3.14159265358979323846;

reference::GlintProcess process_of(const GlintGrid& grid) {
  return {grid.distribution == Distribution::beckmann,
          grid.alpha_x,
          grid.alpha_y,
          grid.density,
          grid.stretch,
          grid.seed};
}

/// Uniform numbers in [0, 1).
class Uniform {
 public:
  explicit Uniform(std::uint64_t seed) : seed_(seed) {}
  double operator()() { return synthesis::random_unit(seed_, 0, counter_++); }
  double logarithmic(double low, double high) { return low * std::pow(high / low, (*this)()); }

 private:
  std::uint64_t seed_, counter_ = 0;
};

GlintGrid grid_of(Distribution distribution, double alpha, double density) {
  GlintGrid grid;
  grid.distribution = distribution;
  grid.alpha_x = grid.alpha_y = alpha;
  grid.density = density;
  return grid;
}

/// Footprints of 1e-3 to 1e3 cells, round and thin, and half vectors that follow the distribution.
std::vector<Query> queries_for(const GlintGrid& grid, int count, std::uint64_t seed) {
  Uniform random(seed);
  const reference::GlintProcess process = process_of(grid);
  std::vector<Query> queries(count);
  for (Query& query : queries) {
    query.footprint.mean_uv = {100 * random() - 50, 100 * random() - 50};
    const double sigma = random.logarithmic(1e-3, 1e3) / std::sqrt(grid.density);
    const double aspect = random() < 0.5 ? 1 : random.logarithmic(1, 100), angle = kPi * random();
    const Eigen::Matrix2d turn = Eigen::Rotation2Dd(angle).toRotationMatrix();
    const Eigen::DiagonalMatrix<double, 2> variance(sigma * sigma, sigma * sigma / (aspect * aspect));
    query.footprint.cov_uv = turn * variance * turn.transpose();
    const double radius = 0.49 * std::sqrt(random()), turned = 2 * kPi * random();
    query.half_vector =
        process.from_disk(Eigen::Vector2d(0.5 + radius * std::cos(turned), 0.5 + radius * std::sin(turned)));
    query.roughness = random.logarithmic(5e-3, 0.1);
  }
  return queries;
}

class Grid : public testing::TestWithParam<Distribution> {
 protected:
  Device device_{0};
};

TEST_P(Grid, IsItsDefinition) {
  double worst = 0;
  for (const double alpha : {0.1, 0.4, 0.8}) {
    for (const double density : {1e3, 1e7}) {
      GlintGrid grid = grid_of(GetParam(), alpha, density);
      grid.alpha_y = 0.7 * alpha, grid.stretch = 3;
      const std::vector<Query> queries = queries_for(grid, 4000, 7);
      const std::vector<float> densities = GridEvaluator(device_, grid).evaluate(queries);
      const reference::GlintProcess process = process_of(grid);
      for (std::size_t n = 0; n < queries.size(); ++n) {
        const double expected = process.density_of(queries[n]),
                     smooth = process.smooth_density(queries[n].half_vector);
        worst = std::max(worst, std::abs(densities[n] - expected) / (1e-4 * expected + 1e-6 * smooth));
      }
    }
  }
  std::printf("worst error, of what is allowed: %.3f\n", worst);
  EXPECT_LE(worst, 1);
}

std::string name_of(const testing::TestParamInfo<Distribution>& info) {
  return info.param == Distribution::beckmann ? "Beckmann" : "TrowbridgeReitz";
}
INSTANTIATE_TEST_SUITE_P(Distributions, Grid,
                         testing::Values(Distribution::beckmann, Distribution::trowbridge_reitz), name_of);

}  // namespace
}  // namespace mica
