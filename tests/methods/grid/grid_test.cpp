// `grid` against its definition in double precision, against closed forms, and against what it promises on
// average. [Kem25]
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

#include "host/base/constants.h"
#include "host/base/random.h"
#include "host/device/launch.h"
#include "host/methods/grid/grid_evaluator.h"
#include "host/reference/glint_grid.h"
#include "mica/error.h"

namespace mica::host::grid_test {
namespace {

reference::GlintProcess process_of(const GlintGrid& grid) {
  return reference::GlintProcess(grid.point());
}

/// Uniform numbers in [0, 1).
class Uniform {
 public:
  explicit Uniform(std::uint64_t seed) : seed_(seed) {}
  double operator()() { return random_unit(seed_, 0, counter_++); }
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

/// Rows of `pitch` points through one of the kernels that exist for tests.
std::vector<float> map_points(Device* device, const std::string& kernel_name, const GlintGrid& grid,
                              const std::vector<float>& points, std::size_t rows_out) {
  const int beckmann = grid.distribution == Distribution::beckmann;
  cl::Kernel kernel =
      device->kernel("grid/grid.cl", kernel_name, "-DMICA_DISTRIBUTION=" + std::to_string(1 - beckmann));
  const std::size_t pitch = points.size() / 2;
  std::vector<float> result(rows_out * pitch);
  const cl::Buffer in = device->upload(points, "points");
  const cl::Buffer out = device->buffer(result.size() * sizeof(float), CL_MEM_WRITE_ONLY, "results");
  launch(*device, kernel, launch_size(device->wave_form(), pitch / kWaveLanes), in,
         static_cast<cl_int>(pitch), static_cast<float>(grid.alpha_x), static_cast<float>(grid.alpha_y), out);
  device->queue().enqueueReadBuffer(out, CL_TRUE, 0, result.size() * sizeof(float), result.data());
  return result;
}

/// Points of the unit square's disk, the first ones at its centre and rim, then uniform: x row, y row.
std::vector<float> disk_points(std::size_t count) {
  Uniform random(11);
  std::vector<float> points(2 * count);
  for (std::size_t n = 0; n < count; ++n) {
    const double radius = n == 0 ? 0 : n < 1000 ? 0.5 * (1 - 1e-6 * random()) : 0.5 * std::sqrt(random());
    const double angle = 2 * kPi * random();
    points[n] = static_cast<float>(0.5 + radius * std::cos(angle));
    points[count + n] = static_cast<float>(0.5 + radius * std::sin(angle));
  }
  return points;
}

TEST_P(Grid, MapsAreInversesOfEachOther) {
  constexpr std::size_t count = 1 << 20;
  const std::vector<float> points = disk_points(count);
  for (const double alpha : {0.02, 0.3, 1.0}) {
    GlintGrid grid = grid_of(GetParam(), alpha, 1e6);
    grid.alpha_y = 0.5 * alpha;
    const std::vector<float> half_vectors = map_points(&device_, "grid_from_disk", grid, points, 2);
    const std::vector<float> back = map_points(&device_, "grid_to_disk", grid, half_vectors, 3);
    double worst = 0;
    for (std::size_t n = 0; n < count; ++n) {
      ASSERT_LE(std::hypot(half_vectors[n], half_vectors[count + n]), 1 + 1e-6);
      // Near the rim a half vector in single precision no longer tells where on the disk it came from: the
      // disk's radius is where 1 - s^2 - t^2, rounded to 6e-8, leaves it.
      const reference::GlintProcess process = process_of(grid);
      const Eigen::Vector2d half(half_vectors[n], half_vectors[count + n]),
          point(points[n], points[count + n]);
      const double rounding = half.squaredNorm() > 0.99
                                  ? (process.to_disk(half * (1 - 1.2e-7)) - process.to_disk(half)).norm()
                                  : 0;
      const double error = std::hypot(back[n] - point.x(), back[count + n] - point.y());
      worst = std::max(worst, error - rounding);
    }
    EXPECT_LE(worst, 1e-5) << alpha;
  }
}

TEST_P(Grid, MapsKeepAreas) {
  constexpr std::size_t count = 1 << 20;
  const std::vector<float> points = disk_points(count);
  GlintGrid grid = grid_of(GetParam(), 0.4, 1e6);
  grid.alpha_y = 0.25;
  const std::vector<float> half_vectors = map_points(&device_, "grid_from_disk", grid, points, 2);
  const std::vector<float> mapped = map_points(&device_, "grid_to_disk", grid, half_vectors, 3);
  const reference::GlintProcess process = process_of(grid);
  double worst_map = 0, worst_density = 0, worst_jacobian = 0;
  for (std::size_t n = 0; n < count; ++n) {
    const Eigen::Vector2d half(half_vectors[n], half_vectors[count + n]);
    const double cos2 = 1 - half.squaredNorm();
    if (cos2 < 1e-3) continue;  // where the difference below would leave the disk
    worst_map =
        std::max(worst_map, (process.to_disk(half) - Eigen::Vector2d(mapped[n], mapped[count + n])).norm());
    const double expected = process.smooth_density(half);
    worst_density = std::max(worst_density, std::abs(mapped[2 * count + n] - expected) / (expected + 1e-3));
    const double step = 1e-4 * cos2;
    Eigen::Matrix2d jacobian;
    for (int axis = 0; axis < 2; ++axis) {
      const Eigen::Vector2d d = step * Eigen::Vector2d::Unit(axis);
      jacobian.col(axis) = (process.to_disk(half + d) - process.to_disk(half - d)) / (2 * step);
    }
    const double area = kPi / 4 * expected;  // Eq. 3
    worst_jacobian =
        std::max(worst_jacobian, std::abs(std::abs(jacobian.determinant()) - area) / (area + 1e-3));
  }
  EXPECT_LE(worst_map, 1e-6);
  EXPECT_LE(worst_density, 1e-4);
  EXPECT_LE(worst_jacobian, 1e-4);
}

/// Mean and its standard error of D / D_smooth over footprints far from each other.
struct Mean {
  double mean, error;
};
Mean mean_ratio(Device* device, const GlintGrid& grid, double sigma_cells, double disk_radius, double micro,
                int count) {
  Uniform random(23);
  const reference::GlintProcess process = process_of(grid);
  std::vector<Query> queries(count);
  for (Query& query : queries) {
    query.footprint.mean_uv = {1e3 * random(), 1e3 * random()};
    query.footprint.cov_uv *= sigma_cells * sigma_cells / grid.density;
    const double turned = 2 * kPi * random();
    query.half_vector = process.from_disk(Eigen::Vector2d(0.5 + 0.5 * disk_radius * std::cos(turned),
                                                          0.5 + 0.5 * disk_radius * std::sin(turned)));
    query.roughness = micro;
  }
  const std::vector<float> densities = GridEvaluator(*device, grid).evaluate(queries);
  double sum = 0, squares = 0;
  for (std::size_t n = 0; n < queries.size(); ++n) {
    const double ratio = densities[n] / process.smooth_density(queries[n].half_vector);
    sum += ratio, squares += ratio * ratio;
  }
  const double mean = sum / count;
  return {mean, std::sqrt(std::max(squares / count - mean * mean, 0.0) / count)};
}

TEST_P(Grid, IsTheSmoothDistributionOnAverage) {
  // Footprints of many cells, where a mean over 2^20 of them is sharp, and lobes that are far from the rim.
  const std::pair<double, double> corners[] = {{0.1, 1e3}, {0.1, 1e8}, {0.3, 1e5}, {0.8, 1e3}, {0.8, 1e8}};
  for (const auto& [alpha, density] : corners) {
    const Mean mean = mean_ratio(&device_, grid_of(GetParam(), alpha, density), 3, 0.5, 0.1 * alpha, 1 << 20);
    EXPECT_LE(mean.error, 0.003) << alpha << " " << density;
    EXPECT_NEAR(mean.mean, 1, 0.01) << alpha << " " << density;
  }
}

TEST_P(Grid, ZoomsWithoutLosingEnergy) {
  const GlintGrid grid = grid_of(GetParam(), 0.3, 1e6);
  for (double cells = 1; cells < 1.1e6; cells *= std::sqrt(10.0)) {  // in a pixel, whose sides are two sigma
    const Mean mean = mean_ratio(&device_, grid, 0.5 * std::sqrt(cells), 0.6, 0.03, 1 << 18);
    EXPECT_NEAR(mean.mean, 1, 0.03) << cells;
    EXPECT_LE(mean.error, 0.01) << cells;
  }
}

/// Zooming out by 2% a frame: how much D changes from one frame to the next, over its spread, at no place
/// between two levels stands out from the others. Eq. 8 is at its fastest just before a level is gone.
TEST_P(Grid, ZoomsWithoutPopping) {
  const GlintGrid grid = grid_of(GetParam(), 0.3, 1e6);
  const reference::GlintProcess process = process_of(grid);
  constexpr std::size_t pixels = 1 << 14;
  constexpr int frames = 105, octave = 35;  // 1.02^35 = 2: a level
  Uniform random(31);
  std::vector<Query> queries(pixels);
  for (Query& query : queries) {
    query.footprint.mean_uv = {random(), random()};
    query.half_vector = {0.1, 0.15};
    query.roughness = 0.03;
  }
  const double smooth = process.smooth_density(queries[0].half_vector);
  GridEvaluator evaluator(device_, grid);
  std::vector<double> changes(octave);
  std::vector<float> before;
  for (int frame = 0; frame < frames; ++frame) {
    const double sigma = 1e-3 * std::pow(2.0, static_cast<double>(frame) / octave);  // from one cell on
    for (Query& query : queries) query.footprint.cov_uv = sigma * sigma * Eigen::Matrix2d::Identity();
    const std::vector<float> densities = evaluator.evaluate(queries);
    double change = 0, spread = 0;
    for (std::size_t n = 0; n < pixels && frame > 0; ++n) {
      change += std::pow(densities[n] - before[n], 2);
      spread += std::pow(densities[n] - smooth, 2);
    }
    if (frame > 0) changes[frame % octave] += std::sqrt(change / spread) / 3;
    before = densities;
  }
  std::sort(changes.begin(), changes.end());
  const double median = changes[octave / 2], most = changes.back();
  std::printf("change between frames, over the spread: %.3f, at most %.3f\n", median, most);
  EXPECT_LE(most, 2 * median);
  EXPECT_LE(most, 0.2);
}

TEST_P(Grid, StaysFiniteOnHardCases) {
  std::vector<Query> queries;
  for (const double uv : {0.0, -1e7, 1e7}) {
    for (const double sigma : {0.0, 1e-6, 1.0, 1e6}) {
      for (const double aspect : {0.0, 1e-6, 1.0}) {
        for (const double s : {0.0, 0.5, 1.0, -0.99999994, 1e-20}) {
          for (const double micro : {1e-4, 1.0}) {
            Query query;
            query.footprint.mean_uv = {uv, 0.3 * uv};
            query.footprint.cov_uv << sigma * sigma, 0, 0, sigma * sigma * aspect * aspect;
            query.half_vector = {s, 0};
            query.roughness = micro;
            ASSERT_EQ(grid_query_problem(query), "");
            queries.push_back(query);
          }
        }
      }
    }
  }
  for (const double alpha : {1e-4, 1.0}) {
    for (const double density : {1.0, 1e12}) {
      for (const double stretch : {1.0 / 64, 64.0}) {
        GlintGrid grid = grid_of(GetParam(), alpha, density);
        grid.stretch = stretch;
        for (const float value :
             GridEvaluator(device_, grid).evaluate(queries)) {  // throws when one is not finite
          ASSERT_GE(value, 0);
        }
      }
    }
  }
}

TEST_P(Grid, DependsOnTheQueryAlone) {
  const GlintGrid grid = grid_of(GetParam(), 0.3, 1e5);
  std::vector<Query> queries = queries_for(grid, 1000, 3);
  const std::vector<float> whole = GridEvaluator(device_, grid).evaluate(queries);
  EXPECT_EQ(GridEvaluator(device_, grid, {}, 37).evaluate(queries), whole);
  std::reverse(queries.begin(), queries.end());
  std::vector<float> reversed = GridEvaluator(device_, grid).evaluate(queries);
  std::reverse(reversed.begin(), reversed.end());
  EXPECT_EQ(reversed, whole);
  EXPECT_TRUE(GridEvaluator(device_, grid).evaluate({}).empty());
}

TEST_P(Grid, RefusesWhatItCannotDo) {
  EXPECT_THROW(GridEvaluator(device_, grid_of(GetParam(), 0, 1e6)), UsageError);
  EXPECT_THROW(GridEvaluator(device_, grid_of(GetParam(), 0.3, std::nan(""))), UsageError);
  Query query;
  query.footprint.cov_uv << 1, 2, 2, 1;
  EXPECT_NE(grid_query_problem(query), "");
  query = Query(), query.half_vector = {std::nan(""), 0};
  EXPECT_NE(grid_query_problem(query), "");
  query = Query(), query.roughness = 2;
  EXPECT_NE(grid_query_problem(query), "");
  query = Query(), query.footprint.mean_uv = {1e8, 0};
  EXPECT_NE(grid_query_problem(query), "");
}

std::string name_of(const testing::TestParamInfo<Distribution>& info) {
  return info.param == Distribution::beckmann ? "Beckmann" : "TrowbridgeReitz";
}
INSTANTIATE_TEST_SUITE_P(Distributions, Grid,
                         testing::Values(Distribution::beckmann, Distribution::trowbridge_reitz), name_of);

}  // namespace
}  // namespace mica::host::grid_test
