// The oracle on queries whose half vector turns over the footprint and whose lobe is not round.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <limits>

#include "host/base/constants.h"
#include "host/base/random.h"
#include "host/reference/binning.h"
#include "host/reference/oracle.h"
#include "host/surface/interpolate.h"
#include "mica/error.h"

namespace mica::host::reference::first_order_test {
namespace {

Eigen::Matrix2d covariance(double sigma_major, double sigma_minor, double angle) {
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(angle).toRotationMatrix();
  const Eigen::Vector2d variances(sigma_major * sigma_major, sigma_minor * sigma_minor);
  Eigen::Matrix2d result = turn * variances.asDiagonal() * turn.transpose();
  result(1, 0) = result(0, 1);
  return result;
}

double gaussian(const Eigen::Vector2d& x, const Eigen::Matrix2d& cov) {
  return std::exp(-0.5 * x.dot(cov.inverse() * x)) / (2 * kPi * std::sqrt(cov.determinant()));
}

/// What a query is, in texels.
struct Turned {
  Eigen::Vector2d mean;
  Eigen::Matrix2d cov, turn;  // texels^2; a texel
  Eigen::Vector2d half_vector;
  Eigen::Matrix2d lobe;

  Query on(const Surface& surface) const {
    const Eigen::Vector2d size(surface.width(), surface.height());
    Query query;
    query.footprint.mean_uv = mean.cwiseQuotient(size);
    query.footprint.cov_uv = cov.cwiseQuotient(size * size.transpose());
    query.half_vector = half_vector;
    query.half_vector_turn = turn * size.asDiagonal();
    query.lobe_cov = lobe;
    return query;
  }
};

Eigen::Matrix2d matrix(double a, double b, double c, double d) {
  Eigen::Matrix2d result;
  result << a, b, c, d;
  return result;
}

/// A map of independent random normals with components within +-range around (0.1, -0.05), plus a slope from
/// the map's centre.
Surface random_surface(int width, int height, Interpolation interpolation, double range,
                       const Eigen::Matrix2d& slope = Eigen::Matrix2d::Zero()) {
  std::vector<Eigen::Vector2d> normals(static_cast<std::size_t>(width) * height);
  for (std::size_t k = 0; k < normals.size(); ++k) {
    const auto random = [&](std::uint64_t stream) { return 2 * random_unit(1, stream, k) - 1; };
    const Eigen::Vector2d centre(static_cast<double>(k % width) + 0.5 - 0.5 * width,
                                 static_cast<double>(k / width) + 0.5 - 0.5 * height);
    normals[k] = Eigen::Vector2d(0.1 + range * random(0), -0.05 + range * random(1)) + slope * centre;
  }
  return Surface(width, height, interpolation, std::move(normals));
}

void expect_near_relative(const OracleResult& result, double expected, double relative) {
  EXPECT_NEAR(result.density, expected, relative * expected);
  EXPECT_LE(std::abs(result.density - expected), result.error_estimate + 1e-12 * expected);
  EXPECT_LE(result.error_estimate, 1e-8 * expected + 1e-50);
}

TEST(OracleFirstOrder, OfAFlatMapIsTheLobeWidenedByTheTurn) {
  const Eigen::Vector2d normal(0.3, -0.2);
  for (const Interpolation interpolation :
       {Interpolation::nearest, Interpolation::bilinear, Interpolation::bicubic}) {
    const Surface surface(5, 3, interpolation, std::vector<Eigen::Vector2d>(15, normal));
    const Oracle oracle(surface);
    for (const double sigma : {0.02, 0.7, 6.0}) {
      for (const double lobe : {1e-4, 0.01, 0.3}) {
        for (const double turns : {0.0, 0.1, 1.0, 30.0}) {  // lobes a standard deviation of the footprint
          for (const double off : {0.0, 2.0, 6.0}) {
            Turned query{{1.3, 2.2},
                         covariance(sigma, 0.3 * sigma, 0.4),
                         Eigen::Matrix2d::Zero(),
                         normal,
                         covariance(lobe, 0.25 * lobe, 1.1)};
            query.turn = turns * lobe / sigma * matrix(0.8, -0.3, 0.5, 0.6);
            const Eigen::Matrix2d wide = query.lobe + query.turn * query.cov * query.turn.transpose();
            query.half_vector += off * lobe * std::hypot(1, turns) * Eigen::Vector2d(0.6, 0.8);
            const double expected = gaussian(query.half_vector - normal, wide);
            if (expected > 1e-12 * gaussian({0, 0}, wide))
              expect_near_relative(oracle.evaluate(query.on(surface)), expected, 1e-8);
          }
        }
      }
    }
  }
}

TEST(OracleFirstOrder, IsConstantOnAMapThatTurnsAlike) {
  const Eigen::Matrix2d slope = matrix(0.002, -0.001, 0.0015, 0.003);
  for (const Interpolation interpolation : {Interpolation::bilinear, Interpolation::bicubic}) {
    const Surface plain = random_surface(64, 64, interpolation, 0.02);
    const Surface sloped = random_surface(64, 64, interpolation, 0.02, slope);
    const Oracle oracle(plain), sloped_oracle(sloped);
    for (const double lobe : {1e-3, 0.01, 0.05}) {
      for (const double sigma : {0.3, 3.0}) {
        const Eigen::Vector2d mean(33.1, 30.4);
        Turned query{mean,
                     covariance(sigma, 0.4 * sigma, 2.0),
                     Eigen::Matrix2d::Zero(),
                     {0.1, -0.05},
                     covariance(lobe, 0.5 * lobe, 0.3)};
        const double density = oracle.evaluate(query.on(plain)).density;
        query.turn = slope;
        query.half_vector += slope * (mean - Eigen::Vector2d(32, 32));
        EXPECT_NEAR(sloped_oracle.evaluate(query.on(sloped)).density, density, 1e-8 * density);
      }
    }
  }
}

/// The integral by 15 x 15 Gauss points on both halves of every small square of the plane that is smooth
/// inside.
double brute_force(const Surface& surface, const Turned& query, int squares_a_texel, double reach_texels) {
  using Rule = boost::math::quadrature::gauss<double, 15>;
  const auto integrand = [&](const Eigen::Vector2d& u) {
    const Eigen::Vector2d offset = u - query.mean;
    return gaussian(offset, query.cov) *
           gaussian(normal_at(surface, u) - query.half_vector - query.turn * offset, query.lobe);
  };
  const double side = 1.0 / squares_a_texel;
  const auto over_square = [&](double x, double y) {
    const Eigen::Vector2d corner(x, y), far(x + side, y + side);
    const auto over_line = [&](double a) {
      const auto both = [&](double b) {
        const Eigen::Vector2d p(side * a * (1 - b), side * a * b);
        return a * side * side * (integrand(corner + p) + integrand(far - p));
      };
      return Rule::integrate(both, 0.0, 1.0);
    };
    return Rule::integrate(over_line, 0.0, 1.0);
  };
  const int reach = static_cast<int>(std::ceil(reach_texels * squares_a_texel));
  const double start_x = std::floor(query.mean.x()) + 0.5, start_y = std::floor(query.mean.y()) + 0.5;
  double sum = 0;
  for (int j = -reach; j < reach; ++j)
    for (int i = -reach; i < reach; ++i) sum += over_square(start_x + i * side, start_y + j * side);
  return sum;
}

TEST(OracleFirstOrder, AgreesWithBruteForce) {
  for (const Interpolation interpolation :
       {Interpolation::nearest, Interpolation::bilinear, Interpolation::bicubic}) {
    const Surface surface = random_surface(3, 5, interpolation, 0.1);
    const Oracle oracle(surface);
    const int squares = interpolation == Interpolation::bilinear  ? 1
                        : interpolation == Interpolation::nearest ? 2
                                                                  : 4;
    for (const double turns : {0.3, 1.0, 3.0}) {
      const Turned wide{{2.9, 0.2},
                        covariance(1.1, 0.6, 1.0),
                        turns * matrix(0.06, 0.02, -0.05, 0.08),
                        {0.08, -0.1},
                        covariance(0.12, 0.05, 0.7)};
      expect_near_relative(oracle.evaluate(wide.on(surface)), brute_force(surface, wide, 2 * squares, 9),
                           1e-8);
      const Turned narrow{{-4.4, 13.3},
                          covariance(0.3, 0.2, 2.0),
                          turns * matrix(0.1, -0.2, 0.15, 0.05),
                          {0.15, -0.02},
                          covariance(0.04, 0.06, 0.2)};
      expect_near_relative(oracle.evaluate(narrow.on(surface)), brute_force(surface, narrow, 4 * squares, 3),
                           1e-8);
    }
  }
}

/// Where even what the half vector's turn picks out of the footprint spans periods, places and half vectors
/// part: the lobe is as wide as both, and sees all of the map.
TEST(OracleFirstOrder, WideFootprintsTendToTheWholeMap) {
  const Surface surface = random_surface(6, 6, Interpolation::bilinear, 0.3);
  const Oracle oracle(surface);
  Turned query{{1, 2},
               covariance(14, 11, 0.4),
               matrix(0.002, 0.003, -0.001, 0.004),
               {0.2, 0.1},
               covariance(0.06, 0.03, 0.5)};
  const double density = oracle.evaluate(query.on(surface)).density;
  query.lobe += query.turn * query.cov * query.turn.transpose();
  query.turn.setZero();
  query.cov *= 100;
  EXPECT_NEAR(density, oracle.evaluate(query.on(surface)).density, 1e-8 * density);
}

TEST(OracleFirstOrder, ARoundLobeIsTheRoughness) {
  const Surface surface = random_surface(7, 9, Interpolation::bilinear, 0.2);
  const Oracle oracle(surface);
  const Turned turned{
      {3, 4}, covariance(1.5, 0.8, 1.2), Eigen::Matrix2d::Zero(), {0.1, 0}, covariance(0.05, 0.05, 0)};
  Query query = turned.on(surface);
  query.roughness = std::nan("");  // not looked at
  const double density = oracle.evaluate(query).density;
  query.lobe_cov.reset();
  query.roughness = 0.05;
  EXPECT_NEAR(oracle.evaluate(query).density, density, 1e-10 * density);
}

TEST(OracleFirstOrder, IsWhatBinsHold) {
  const Surface surface = random_surface(8, 8, Interpolation::bilinear, 0.1);
  Turned query{{3.3, 4.1},
               covariance(1.2, 0.5, 0.9),
               matrix(0.08, -0.03, 0.05, 0.1),
               {0, 0},
               covariance(0.06, 0.03, 0.4)};
  BinningSettings settings;
  settings.samples = 20'000'000;
  settings.bins = 16;
  settings.window_center = {0.1, -0.05};
  settings.window_radius = 0.4;
  const BinnedNdf ndf = bin_normals(surface, query.on(surface), settings);
  constexpr int points = 4;  // a side of a bin, at the middles of its parts: 2e-3 of a bin's mean
  std::vector<Query> queries;
  for (int n = 0; n < settings.bins * settings.bins * points * points; ++n) {
    const int bin = n / (points * points), x = n % points, y = n / points % points;
    query.half_vector = ndf.bin_center(bin % settings.bins, bin / settings.bins) +
                        ndf.bin_side() / points * Eigen::Vector2d(x - 1.5, y - 1.5);
    queries.push_back(query.on(surface));
  }
  const std::vector<double> densities = evaluate(surface, queries);
  const double a_count = 1 / (static_cast<double>(settings.samples) * ndf.bin_side() * ndf.bin_side());
  for (int bin = 0; bin < settings.bins * settings.bins; ++bin) {
    double mean = 0;
    for (int k = 0; k < points * points; ++k)
      mean += densities[bin * points * points + k] / (points * points);
    const double deviation = std::sqrt(mean * a_count) + a_count;
    EXPECT_NEAR(ndf.density(bin % settings.bins, bin / settings.bins), mean, 5 * deviation + 5e-3 * mean)
        << bin;
  }
}

TEST(OracleFirstOrder, RefusesWhatHasNoAnswer) {
  const Surface surface = random_surface(4, 4, Interpolation::bilinear, 0.1);
  const Query good =
      Turned{{1, 1}, covariance(1, 1, 0), matrix(0.1, 0, 0, 0.1), {0, 0}, covariance(0.1, 0.05, 0)}.on(
          surface);
  EXPECT_NO_THROW(evaluate(surface, good));
  const auto refuses = [&](const Eigen::Matrix2d& turn, const Eigen::Matrix2d& lobe) {
    Query query = good;
    query.half_vector_turn = turn, query.lobe_cov = lobe;
    EXPECT_THROW(evaluate(surface, query), UsageError);
  };
  const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
  refuses(matrix(nan, 0, 0, 0), *good.lobe_cov);
  refuses(matrix(0, 0, infinity, 0), *good.lobe_cov);
  refuses(good.half_vector_turn, matrix(1e-4, nan, nan, 1e-4));
  refuses(good.half_vector_turn, matrix(1e-4, 1e-5, 2e-5, 1e-4));
  refuses(good.half_vector_turn, matrix(1e-4, 2e-4, 2e-4, 1e-4));
  refuses(good.half_vector_turn, matrix(-1e-4, 0, 0, -1e-4));
  refuses(good.half_vector_turn, matrix(0, 0, 0, 0));
}

}  // namespace
}  // namespace mica::host::reference::first_order_test
