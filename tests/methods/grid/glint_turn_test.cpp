// `grid` where the half vector turns over the footprint and lobes of glints are not round.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "host/base/constants.h"
#include "host/base/random.h"
#include "host/base/symmetric_matrix.h"
#include "host/methods/grid/grid_evaluator.h"
#include "host/reference/glint_grid.h"

namespace mica::host::glint_turn_test {
namespace {

class Uniform {
 public:
  explicit Uniform(std::uint64_t seed) : seed_(seed) {}
  double operator()() { return random_unit(seed_, 0, counter_++); }
  double logarithmic(double low, double high) { return low * std::pow(high / low, (*this)()); }
  Eigen::Vector2d in_disk(double radius) {
    const double r = radius * std::sqrt((*this)()), angle = 2 * kPi * (*this)();
    return {0.5 + r * std::cos(angle), 0.5 + r * std::sin(angle)};
  }

 private:
  std::uint64_t seed_, counter_ = 0;
};

GlintGrid grid_of(Distribution distribution, double alpha) {
  GlintGrid grid;
  grid.distribution = distribution;
  grid.alpha_x = grid.alpha_y = alpha;
  return grid;
}

Eigen::Matrix2d ellipse(double major, double minor, double angle) {
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(angle).toRotationMatrix();
  Eigen::Matrix2d covariance =
      turn * Eigen::Vector2d(major * major, minor * minor).asDiagonal() * turn.transpose();
  covariance(1, 0) = covariance(0, 1);
  return covariance;
}

/// A turn by `turns` lobes over the footprint's longer axis, as a sphere's over an oblique footprint.
Eigen::Matrix2d turn_of(const Footprint& footprint, double lobe, double turns, double angle) {
  Eigen::Matrix2d shape;
  shape << std::cos(angle), -std::sin(angle), 0.7 * std::sin(angle), 0.7 * std::cos(angle);
  return turns * lobe / std::sqrt(principal_axes(footprint.cov_uv).eigenvalues[1]) * shape;
}

/// Footprints of 1e-2 to 100 cells to 4:1 (beyond, a float does not tell which angular cell is the nearest),
/// lobes to 4:1, half vectors that follow the distribution and turn by 0.1 to 4 lobes over the footprint's
/// standard deviation.
std::vector<Query> turned_queries(const GlintGrid& grid, std::size_t count, std::uint64_t seed) {
  Uniform random(seed);
  const reference::GlintProcess process(grid.point());
  std::vector<Query> queries(count);
  for (Query& query : queries) {
    query.footprint.mean_uv = {100 * random() - 50, 100 * random() - 50};
    const double sigma = random.logarithmic(1e-2, 100) / std::sqrt(grid.density);
    query.footprint.cov_uv = ellipse(sigma, sigma / random.logarithmic(1, 4), kPi * random());
    query.half_vector = process.from_disk(random.in_disk(0.45));
    const double lobe = random.logarithmic(5e-3, 0.1);
    query.lobe_cov = ellipse(lobe * random.logarithmic(1, 4), lobe, kPi * random());
    query.half_vector_turn = turn_of(query.footprint, lobe, random.logarithmic(0.1, 4), 2 * kPi * random());
  }
  return queries;
}

class GlintTurns : public testing::TestWithParam<Distribution> {
 protected:
  /// The worst error, of what is allowed.
  double worst_error(const GlintGrid& grid, const std::vector<Query>& queries) {
    const std::vector<float> densities = GridEvaluator(device_, grid).evaluate(queries);
    const reference::GlintProcess process(grid.point());
    double worst = 0;
    for (std::size_t n = 0; n < queries.size(); ++n) {
      EXPECT_EQ(grid_query_problem(queries[n]), "");
      const double expected = process.density_of(queries[n]),
                   smooth = process.smooth_density(queries[n].half_vector);
      worst = std::max(worst, std::abs(densities[n] - expected) / (1e-4 * expected + 1e-6 * smooth));
    }
    return worst;
  }

  Device device_{0};
};

TEST_P(GlintTurns, IsItsDefinition) {
  double worst = 0;
  for (const double alpha : {0.1, 0.4, 0.8}) {
    for (const double density : {1e3, 1e7}) {
      GlintGrid grid = grid_of(GetParam(), alpha);
      grid.alpha_y = 0.7 * alpha, grid.stretch = 3, grid.density = density;
      worst = std::max(worst, worst_error(grid, turned_queries(grid, 4000, 7)));
    }
  }
  std::printf("worst error, of what is allowed: %.3f\n", worst);
  EXPECT_LE(worst, 1);
}

/// A turn that is next to none, and a lobe that is round: the answers are those of the other kernel.
TEST_P(GlintTurns, IsWithoutATurnWhatItWas) {
  const GlintGrid grid = grid_of(GetParam(), 0.3);
  std::vector<Query> turned = turned_queries(grid, 4000, 11);
  std::vector<Query> plain = turned;
  for (std::size_t n = 0; n < turned.size(); ++n) {
    plain[n].lobe_cov.reset(), plain[n].half_vector_turn.setZero();
    turned[n].lobe_cov = plain[n].roughness * plain[n].roughness * Eigen::Matrix2d::Identity();
    turned[n].half_vector_turn *= 1e-12;
  }
  GridEvaluator evaluator(device_, grid);
  const std::vector<float> expected = evaluator.evaluate(plain), densities = evaluator.evaluate(turned);
  const reference::GlintProcess process(grid.point());
  double worst = 0;
  for (std::size_t n = 0; n < plain.size(); ++n) {
    const double smooth = process.smooth_density(plain[n].half_vector);
    worst = std::max(worst, std::abs(densities[n] - expected[n]) / (1e-4 * expected[n] + 1e-6 * smooth));
  }
  std::printf("worst difference, of what is allowed: %.3f\n", worst);
  EXPECT_LE(worst, 2);  // both are off by one
  for (Query& query : turned) query.half_vector_turn.setZero();
  EXPECT_EQ(evaluator.evaluate(turned), expected);
}

/// Mean of the smooth distribution over a footprint, by its definition: a sum over 64 x 64 points.
double smooth_mean(const reference::GlintProcess& process, const Query& query) {
  constexpr int side = 64;
  const Eigen::Matrix2d factor = query.half_vector_turn * cholesky_factor(query.footprint.cov_uv);
  double sum = 0, weights = 0;
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      const Eigen::Vector2d y(10.0 * (i + 0.5) / side - 5, 10.0 * (j + 0.5) / side - 5);
      const double weight = std::exp(-0.5 * y.squaredNorm());
      sum += weight * process.smooth_density(query.half_vector + factor * y), weights += weight;
    }
  }
  return sum / weights;
}

/// Mean of D over places, in units of that of the smooth distribution, and its standard error.
struct Mean {
  double mean, error;
};
Mean mean_of(Evaluator* evaluator, const GlintGrid& grid, Query query, std::size_t count) {
  Uniform random(23);
  std::vector<Query> queries(count, query);
  for (Query& at : queries) at.footprint.mean_uv = {1e3 * random(), 1e3 * random()};
  double sum = 0, squares = 0;
  for (const float density : evaluator->evaluate(queries)) sum += density, squares += 1.0 * density * density;
  const double smooth = smooth_mean(reference::GlintProcess(grid.point()), query),
               n = static_cast<double>(count);
  const double mean = sum / n;
  return {mean / smooth, std::sqrt((squares / n - mean * mean) / n) / smooth};
}

/// Whatever the turn, and also where it moves both coordinates of the disk alike, so that the spread of what
/// is beyond the cells is correlated.
TEST_P(GlintTurns, AddUpToTheSmoothDistribution) {
  const GlintGrid grid = grid_of(GetParam(), 0.3);
  GridEvaluator evaluator(device_, grid);
  Query query;
  query.half_vector = {0.1, 0.07};
  query.roughness = 0.02;
  query.footprint.cov_uv *= 9 / grid.density;  // three cells
  Eigen::Matrix2d along;
  along << 0.7, 0, 0.7, 0;
  const double sigma = std::sqrt(query.footprint.cov_uv(0, 0));
  for (const double turns : {0.1, 1.0, 2.0, 4.0}) {
    for (const bool line : {false, true}) {
      query.half_vector_turn = line ? Eigen::Matrix2d(turns * query.roughness / sigma * along)
                                    : turn_of(query.footprint, query.roughness, turns, 0.4);
      const Mean mean = mean_of(&evaluator, grid, query, 1 << 18);
      std::printf("turn of %.1f lobes%s: %.4f +- %.4f\n", turns, line ? " along a line" : "", mean.mean,
                  mean.error);
      EXPECT_LE(mean.error, 0.003);
      EXPECT_NEAR(mean.mean, 1, 0.01) << turns << " lobes" << (line ? " along a line" : "");
    }
  }
}

/// Queries near single glints of footprints below an eighth of a cell, which see level 0 alone, of whatever
/// size they are; half vectors turn by two lobes.
std::vector<Query> queries_near_glints(const GlintGrid& grid) {
  const reference::GlintProcess process(grid.point());
  constexpr double lobe = 0.005, sigma_cells = 0.12;
  const double cell = 1 / std::sqrt(grid.density);
  Uniform random(41);
  std::vector<Query> queries;
  for (int i = 0; queries.size() < 64; ++i) {
    const reference::Glint glint = reference::glint_of_cell(i, 3, 0, 0, 0, grid.seed);
    if ((glint.angle - Eigen::Vector2d(0.5, 0.5)).norm() > 0.4) continue;
    Query& query = queries.emplace_back();
    query.roughness = lobe;
    query.footprint.cov_uv *= std::pow(sigma_cells * cell, 2);
    query.half_vector_turn = turn_of(query.footprint, lobe, 2, 2 * kPi * random());
    const Eigen::Vector2d offset = sigma_cells * cell * Eigen::Vector2d(2 * random() - 1, 2 * random() - 1);
    query.footprint.mean_uv = cell * (Eigen::Vector2d(i, 3) + glint.place) - offset;
    query.half_vector = process.from_disk(glint.angle) - query.half_vector_turn * offset;
  }
  return queries;
}

/// D as the sum of small parts of a round footprint, whose constant half vectors follow a turn.
std::vector<double> sums_of_parts(Evaluator* evaluator, const std::vector<Query>& queries,
                                  const Eigen::Matrix2d& sign) {
  constexpr int beside = 56;          // parts to each side
  constexpr double width = 1.0 / 16;  // of a part and between two, in standard deviations of the footprint
  std::vector<double> sums(queries.size());
  double weights = 0;
  for (int i = -beside; i <= beside; ++i) {
    for (int j = -beside; j <= beside; ++j) {
      const Eigen::Vector2d at(width * i, width * j);
      const double weight = std::exp(-0.5 * at.squaredNorm() / (1 - width * width));
      std::vector<Query> parts = queries;
      for (Query& query : parts) {
        const Eigen::Vector2d offset = std::sqrt(query.footprint.cov_uv(0, 0)) * at;
        query.footprint.mean_uv += offset;
        query.half_vector += query.half_vector_turn * sign * offset;
        query.footprint.cov_uv *= width * width, query.half_vector_turn.setZero();
      }
      const std::vector<float> densities = evaluator->evaluate(parts);
      for (std::size_t n = 0; n < sums.size(); ++n) sums[n] += weight * densities[n];
      weights += weight;
    }
  }
  for (double& sum : sums) sum /= weights;
  return sums;
}

/// The glints that a turned query sees are those that small ones along the turn see, which have none.
TEST_P(GlintTurns, AreTheSumOfTheirParts) {
  GlintGrid grid = grid_of(GetParam(), 0.3);
  grid.alpha_y = 0.15;
  GridEvaluator evaluator(device_, grid);
  const std::vector<Query> queries = queries_near_glints(grid);
  const std::vector<float> densities = evaluator.evaluate(queries);
  const auto error = [&](const Eigen::Matrix2d& sign) {
    const std::vector<double> sums = sums_of_parts(&evaluator, queries, sign);
    double squares = 0, errors = 0;
    for (std::size_t n = 0; n < sums.size(); ++n)
      squares += sums[n] * sums[n], errors += std::pow(densities[n] - sums[n], 2);
    return std::sqrt(errors / squares);
  };
  const Eigen::Matrix2d one = Eigen::Matrix2d::Identity();
  const double turned = error(one), back = error(-one);
  std::printf("relative L2 from the parts: %.4f, from parts that turn the other way %.4f\n", turned, back);
  EXPECT_LE(turned, 0.03);
  EXPECT_GE(back, 0.3);
}

TEST_P(GlintTurns, DependOnTheQueryAlone) {
  const GlintGrid grid = grid_of(GetParam(), 0.3);
  std::vector<Query> queries = turned_queries(grid, 1000, 3);
  std::vector<GlintPoint> points(queries.size(), grid.point());
  for (std::size_t n = 0; n < queries.size(); ++n) {
    points[n].seed = static_cast<std::uint32_t>(n), points[n].kept = n % 2 == 0 ? 1.0F : 0.5F;
    if (n % 3 == 0) queries[n].half_vector_turn.setZero();
    if (n % 6 == 0) queries[n].lobe_cov.reset();
    if (n % 9 == 0) queries[n].lobe_cov = 1e-4 * Eigen::Matrix2d::Identity();
  }
  constexpr int colors = 3;
  const auto answers = [&](std::size_t batch_queries) {
    GridEvaluator evaluator(device_, grid, {}, batch_queries, {colors, true});
    const auto pending = evaluator.start_at(queries, points);
    std::vector<std::vector<float>> rows = {pending->wait()};
    for (std::size_t color = 0; color < colors; ++color)
      for (std::size_t n = 0; n < queries.size(); ++n)
        rows.resize(colors + 1), rows[color + 1].push_back(pending->density_of_color(color, n));
    return rows;
  };
  std::vector<std::vector<float>> whole = answers(1 << 18);
  EXPECT_EQ(answers(37), whole);
  for (std::size_t n = 0; n < queries.size(); n += 17) {
    const std::vector<double> expected = reference::GlintProcess(points[n]).densities_of(queries[n], colors);
    for (std::size_t color = 0; color < colors; ++color)
      EXPECT_NEAR(whole[color + 1][n], expected[color], 2e-4 * expected[color] + 1e-3);
  }
  std::reverse(queries.begin(), queries.end()), std::reverse(points.begin(), points.end());
  std::vector<std::vector<float>> reversed = answers(1 << 18);
  for (std::vector<float>& row : reversed) std::reverse(row.begin(), row.end());
  EXPECT_EQ(reversed, whole);
}

/// Standard deviation of D over places, over its mean.
double contrast_of(const reference::GlintProcess& process, Query query) {
  constexpr int count = 3000;
  Uniform random(5);
  double sum = 0, squares = 0;
  for (int n = 0; n < count; ++n) {
    query.footprint.mean_uv = {1e3 * random(), 1e3 * random()};
    const double density = process.density_of(query);
    sum += density, squares += density * density;
  }
  return std::sqrt(squares * count / (sum * sum) - 1);
}

/// Where a turn leaves the 2x2 cells, contrast is lost to the expectation: of that of all glints, that is
/// what is left. docs/grid.md has the table.
TEST_P(GlintTurns, LoseContrastBeyondTheCells) {
  const GlintGrid grid = grid_of(GetParam(), 0.3);
  const reference::GlintProcess process(grid.point());
  reference::GlintProcess all = process;
  all.angular_cells = 32;
  struct Case {
    double lobe, sigma_cells, turns, least, most;
  };
  for (const Case& each : std::initializer_list<Case>{{0.005, 0.3, 4, 0.99, 1.01},
                                                      {0.005, 3, 2, 0.97, 1.03},
                                                      {0.02, 0.3, 2, 0.97, 1.03},
                                                      {0.02, 3, 0, 0.8, 0.95},
                                                      {0.02, 3, 1, 0.7, 0.9},
                                                      {0.02, 3, 4, 0.35, 0.55}}) {
    Query query;
    query.half_vector = {0.1, 0.07};
    query.roughness = each.lobe;
    query.footprint.cov_uv *= each.sigma_cells * each.sigma_cells / grid.density;
    query.half_vector_turn = turn_of(query.footprint, each.lobe, each.turns, 0.4);
    const double contrast = contrast_of(process, query), whole = contrast_of(all, query);
    std::printf("lobe %.3f, %.1f cells, turn of %.1f lobes: contrast %.3f, of all glints %.3f\n", each.lobe,
                each.sigma_cells, each.turns, contrast, whole);
    EXPECT_GE(contrast, each.least * whole);
    EXPECT_LE(contrast, each.most * whole);
  }
}

TEST_P(GlintTurns, RefuseWhatTheyCannotDo) {
  Query query;
  query.footprint.cov_uv *= 1e-6;
  query.half_vector_turn << 1e3, 0, 0, 1e3;
  EXPECT_EQ(grid_query_problem(query), "");
  query.half_vector_turn(0, 0) = 3e3;  // beyond the disk's diameter
  EXPECT_NE(grid_query_problem(query), "");
  query.half_vector_turn(0, 0) = std::nan("");
  EXPECT_NE(grid_query_problem(query), "");
  query.half_vector_turn.setZero();
  for (const double minor : {0.0, 5e-5, -1.0, std::nan("")}) {
    query.lobe_cov = Eigen::Vector2d(1e-4, minor * std::abs(minor)).asDiagonal();
    EXPECT_NE(grid_query_problem(query), "") << minor;
  }
  query.lobe_cov = Eigen::Vector2d(1e-4, 4).asDiagonal();
  EXPECT_NE(grid_query_problem(query), "");
}

TEST_P(GlintTurns, StayFiniteOnHardCases) {
  std::vector<Query> queries;
  for (const double sigma : {0.0, 1e-6, 1.0, 1e6})
    for (const double aspect : {0.0, 1e-6, 1.0})
      for (const double s : {0.0, 0.5, 1.0, -0.99999994, 1e-20})
        for (const double lobe : {1e-4, 1.0})
          for (const double turns : {1e-20, 1e-3, 1.4}) {
            Query query;
            query.footprint.mean_uv = {1e7, -0.3};
            query.footprint.cov_uv << sigma * sigma, 0, 0, sigma * sigma * aspect * aspect;
            query.half_vector = {s, 0};
            query.lobe_cov = ellipse(lobe, std::max(0.1 * lobe, 1e-4), 0.7);
            query.half_vector_turn << 0.7, 0.7, 0.7, 0.7;
            query.half_vector_turn *= turns / std::max(sigma, 1e-9);
            ASSERT_EQ(grid_query_problem(query), "");
            queries.push_back(query);
          }
  for (const double alpha : {1e-4, 1.0})
    for (const double density : {1.0, 1e12})
      for (const double stretch : {1.0 / 64, 64.0}) {
        GlintGrid grid = grid_of(GetParam(), alpha);
        grid.density = density, grid.stretch = stretch;
        GridEvaluator evaluator(device_, grid);
        for (const float value : evaluator.evaluate(queries)) ASSERT_TRUE(std::isfinite(value) && value >= 0);
        EXPECT_EQ(evaluator.replaced(), 0);
      }
}

std::string name_of(const testing::TestParamInfo<Distribution>& info) {
  return info.param == Distribution::beckmann ? "Beckmann" : "TrowbridgeReitz";
}
INSTANTIATE_TEST_SUITE_P(Distributions, GlintTurns,
                         testing::Values(Distribution::beckmann, Distribution::trowbridge_reitz), name_of);

}  // namespace
}  // namespace mica::host::glint_turn_test
