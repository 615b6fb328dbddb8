#include "host/reference/oracle.h"
#include "host/base/constants.h"
#include "host/base/random.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <Eigen/Geometry>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>

#include "host/base/symmetric_matrix.h"
#include "host/reference/gaussian_triangle.h"
#include "host/surface/interpolate.h"
#include "mica/error.h"
#include "tests/reference/fifty_digits.h"

namespace mica::host::reference::oracle_test {
namespace {

double random_number(int stream, std::uint64_t index) {
  return random_unit(1, stream, index);
}

/// A map of independent random normals with components within +-range around (0.1, -0.05).
Surface random_surface(int width, int height, Interpolation interpolation, double range = 0.3) {
  std::vector<Eigen::Vector2d> normals(width * height);
  for (std::size_t k = 0; k < normals.size(); ++k) {
    normals[k] = {0.1 + range * (2 * random_number(0, k) - 1), -0.05 + range * (2 * random_number(1, k) - 1)};
  }
  return Surface(width, height, interpolation, std::move(normals));
}

/// A query in texels: mean, standard deviations along the axes of an ellipse turned by an angle.
Query texel_query(const Surface& surface, Eigen::Vector2d mean, double sigma_major, double sigma_minor,
                  double angle, Eigen::Vector2d half_vector, double roughness) {
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(angle).toRotationMatrix();
  const Eigen::Vector2d variances(sigma_major * sigma_major, sigma_minor * sigma_minor);
  const Eigen::Vector2d to_uv(1.0 / surface.width(), 1.0 / surface.height());
  Query query;
  query.footprint.mean_uv = mean.cwiseProduct(to_uv);
  query.footprint.cov_uv =
      to_uv.asDiagonal() * (turn * variances.asDiagonal() * turn.transpose()) * to_uv.asDiagonal();
  query.footprint.cov_uv(1, 0) = query.footprint.cov_uv(0, 1);
  query.half_vector = half_vector;
  query.roughness = roughness;
  return query;
}

double gaussian(const Eigen::Vector2d& x, const Eigen::Matrix2d& cov) {
  return std::exp(-0.5 * x.dot(cov.inverse() * x)) / (2 * kPi * std::sqrt(cov.determinant()));
}

Eigen::Matrix2d cov_texels(const Surface& surface, const Query& query) {
  const Eigen::Vector2d size(surface.width(), surface.height());
  return size.asDiagonal() * query.footprint.cov_uv * size.asDiagonal();
}

void expect_near_relative(const OracleResult& result, double expected, double relative) {
  EXPECT_NEAR(result.density, expected, relative * expected);
  EXPECT_LE(std::abs(result.density - expected), result.error_estimate + 1e-13 * expected);
  EXPECT_LE(result.error_estimate, 4e-9 * expected + 1e-50);
}

TEST(Oracle, FlatMapIsTheRoughnessItself) {
  const Eigen::Vector2d normal(0.3, -0.2);
  for (const Interpolation interpolation :
       {Interpolation::nearest, Interpolation::bilinear, Interpolation::bicubic}) {
    const Surface surface(5, 3, interpolation, std::vector<Eigen::Vector2d>(15, normal));
    const Oracle oracle(surface);
    for (const double sigma : {0.01, 0.7, 3.0, 40.0, 1e4}) {
      for (const double roughness : {1e-5, 0.01, 1.0}) {
        for (const double off : {0.0, 2.0, 9.0}) {
          const Eigen::Vector2d s = normal + off * roughness * Eigen::Vector2d(0.6, 0.8);
          const double expected = gaussian(s - normal, roughness * roughness * Eigen::Matrix2d::Identity());
          expect_near_relative(
              oracle.evaluate(texel_query(surface, {1.3, 2.2}, sigma, 0.02 * sigma, 0.4, s, roughness)),
              expected, 1e-9);
        }
      }
    }
  }
}

/// Normals that depend linearly on the texel, far from the seam.
Surface ramp(const Eigen::Matrix2d& jacobian, Interpolation interpolation, int size) {
  std::vector<Eigen::Vector2d> normals;
  for (int j = 0; j < size; ++j) {
    for (int i = 0; i < size; ++i) {
      normals.push_back(jacobian * Eigen::Vector2d(i + 0.5 - 0.5 * size, j + 0.5 - 0.5 * size));
    }
  }
  return Surface(size, size, interpolation, std::move(normals));
}

TEST(Oracle, RampIsAConvolutionOfGaussians) {
  Eigen::Matrix2d full, rank_one;
  full << 0.01, 0.004, -0.003, 0.007;
  rank_one << 0.01, 0.005, 0.004, 0.002;
  for (const Eigen::Matrix2d& jacobian : {full, rank_one}) {
    for (const Interpolation interpolation : {Interpolation::bilinear, Interpolation::bicubic}) {
      const Surface surface = ramp(jacobian, interpolation, 64);
      const Oracle oracle(surface);
      for (const double roughness : {1e-4, 1e-3, 0.02, 0.3}) {
        for (const double aspect : {1.0, 100.0}) {
          const Eigen::Vector2d mean(33.1, 30.7), mean_normal = jacobian * (mean - Eigen::Vector2d(32, 32));
          for (const Eigen::Vector2d& step :
               {Eigen::Vector2d(0, 0), Eigen::Vector2d(2, 1), Eigen::Vector2d(-1, 4)}) {
            Query query = texel_query(surface, mean, 2.5, 2.5 / aspect, 0.6, {0, 0}, roughness);
            const Eigen::Matrix2d cov = jacobian * cov_texels(surface, query) * jacobian.transpose() +
                                        roughness * roughness * Eigen::Matrix2d::Identity();
            query.half_vector = mean_normal + cholesky_factor(cov) * step;
            // The closed form in doubles loses digits with the square of |J sigma| / roughness.
            const double lost = 1e-15 * std::pow(0.03 / roughness, 2);
            EXPECT_NEAR(oracle.evaluate(query).density / gaussian(query.half_vector - mean_normal, cov), 1,
                        1e-9 + 10 * lost)
                << roughness << ' ' << aspect;
          }
        }
      }
    }
  }
}

TEST(Oracle, NearestIsASumOverTexelSquares) {
  const Surface surface = random_surface(6, 4, Interpolation::nearest);
  const Oracle oracle(surface);
  const auto interval = [](double a, double b) {  // probability, with the digits of both tails
    const double root_half = std::sqrt(0.5);
    if (a > 0) return 0.5 * (std::erfc(a * root_half) - std::erfc(b * root_half));
    return 0.5 * (std::erfc(-b * root_half) - std::erfc(-a * root_half));
  };
  for (const auto& [sigma_x, sigma_y] : {std::pair(0.3, 0.4), std::pair(1.5, 0.02), std::pair(3.0, 2.0)}) {
    const Query query = texel_query(surface, {2.3, 3.6}, sigma_x, sigma_y, 0, {0.12, -0.1}, 0.05);
    double expected = 0;
    for (int j = -40; j < 40; ++j) {
      for (int i = -40; i < 40; ++i) {
        const double weight = interval((i - 2.3) / sigma_x, (i + 1 - 2.3) / sigma_x) *
                              interval((j - 3.6) / sigma_y, (j + 1 - 3.6) / sigma_y);
        expected +=
            weight * gaussian(query.half_vector - surface.texel(i, j), 0.0025 * Eigen::Matrix2d::Identity());
      }
    }
    expect_near_relative(oracle.evaluate(query), expected, 1e-9);
  }
}

/// Eq. 6 by brute force: 15 x 15 Gauss points on both halves of every small square of the plane that is
/// smooth inside.
double brute_force(const Surface& surface, const Query& query, int squares_a_texel, double reach_texels) {
  using Rule = boost::math::quadrature::gauss<double, 15>;
  const Eigen::Matrix2d cov = cov_texels(surface, query);
  const Eigen::Matrix2d roughness_cov = query.roughness * query.roughness * Eigen::Matrix2d::Identity();
  const Eigen::Vector2d mean =
      query.footprint.mean_uv.cwiseProduct(Eigen::Vector2d(surface.width(), surface.height()));
  const auto integrand = [&](const Eigen::Vector2d& u) {
    return gaussian(u - mean, cov) * gaussian(normal_at(surface, u) - query.half_vector, roughness_cov);
  };
  const double side = 1.0 / squares_a_texel;
  const auto over_square = [&](double x, double y) {
    return Rule::integrate(
        [&](double a) {  // both triangles of the square, each mapped from the unit square
          return Rule::integrate(
              [&](double b) {
                const Eigen::Vector2d p(side * a * (1 - b), side * a * b), corner(x, y),
                    far(x + side, y + side);
                return a * side * side * (integrand(corner + p) + integrand(far - p));
              },
              0.0, 1.0);
        },
        0.0, 1.0);
  };
  const int reach = static_cast<int>(std::ceil(reach_texels * squares_a_texel));
  const double start_x = std::floor(mean.x()) + 0.5, start_y = std::floor(mean.y()) + 0.5;
  double sum = 0;
  for (int j = -reach; j < reach; ++j) {
    for (int i = -reach; i < reach; ++i) sum += over_square(start_x + i * side, start_y + j * side);
  }
  return sum;
}

TEST(Oracle, AgreesWithBruteForce) {
  for (const Interpolation interpolation :
       {Interpolation::nearest, Interpolation::bilinear, Interpolation::bicubic}) {
    const Surface surface = random_surface(3, 5, interpolation, 0.1);
    const Oracle oracle(surface);
    const int squares = interpolation == Interpolation::bilinear  ? 1
                        : interpolation == Interpolation::nearest ? 2
                                                                  : 4;
    const Query wide = texel_query(surface, {2.9, 0.2}, 1.1, 0.6, 1.0, {0.08, -0.1}, 0.1);
    expect_near_relative(oracle.evaluate(wide), brute_force(surface, wide, squares, 9), 1e-9);
    const Query narrow = texel_query(surface, {-4.4, 13.3}, 0.3, 0.2, 2.0, {0.15, -0.02}, 0.05);
    expect_near_relative(oracle.evaluate(narrow), brute_force(surface, narrow, squares, 3), 1e-9);
  }
}

TEST(Oracle, AgreesWithFiftyDigitsAtLowRoughness) {
  // A footprint within a few texels whose normals differ by hundreds of standard deviations.
  const Surface surface = random_surface(8, 8, Interpolation::bilinear, 0.2);
  const Query query = texel_query(surface, {4.2, 3.9}, 0.2, 0.1, 0.5, normal_at(surface, {4.3, 4.0}), 1e-3);
  const QueryFrame frame(surface, query, 0);
  FiftyDigits::Number sum = 0;
  for (int j = 0; j < 7; ++j) {
    for (int i = 0; i < 7; ++i) {
      const auto corner = [&](int di, int dj) {
        Whitened w;
        w << frame.whiten_position({i + di + 0.5, j + dj + 0.5}),
            frame.whiten_normal(surface.texel(i + di, j + dj));
        return w;
      };
      for (const auto& triangle : {std::array{corner(0, 0), corner(1, 0), corner(0, 1)},
                                   std::array{corner(1, 1), corner(0, 1), corner(1, 0)}}) {
        if (flatten(triangle).nearest_squared() < 55) sum += FiftyDigits::mean(triangle) / 2;
      }
    }
  }
  expect_near_relative(evaluate(surface, query), frame.scale() * static_cast<double>(sum), 1e-9);
}

TEST(Oracle, DoesNotDependOnThePeriodNorOnTheSeam) {
  const Surface surface = random_surface(7, 9, Interpolation::bilinear);
  const Oracle oracle(surface);
  const Query query = texel_query(surface, {0.4, 8.7}, 2, 0.5, 0.3, {0.1, 0}, 0.05);
  Query shifted = query;
  shifted.footprint.mean_uv += Eigen::Vector2d(-3, 1024);
  const double density = oracle.evaluate(query).density;
  EXPECT_NEAR(oracle.evaluate(shifted).density, density, 1e-11 * density);

  Query near = query,
        far = query;  // far enough for texel coordinates to lose their fraction if they were not wrapped
  near.footprint.mean_uv = {0.375, 0.25};
  far.footprint.mean_uv = {0.375 + 0x1p45, 0.25 - 0x1p45};
  EXPECT_EQ(oracle.evaluate(far).density, oracle.evaluate(near).density);

  std::vector<Eigen::Vector2d> rolled(63);
  for (int j = 0; j < 9; ++j) {
    for (int i = 0; i < 7; ++i) rolled[j * 7 + i] = surface.texel(i - 3, j - 4);
  }
  Query rolled_query = query;
  rolled_query.footprint.mean_uv += Eigen::Vector2d(3.0 / 7, 4.0 / 9);
  const Surface rolled_surface(7, 9, Interpolation::bilinear, std::move(rolled));
  EXPECT_NEAR(evaluate(rolled_surface, rolled_query).density, density, 1e-11 * density);
}

TEST(Oracle, WideFootprintsTendToTheWholeMap) {
  // Just before and after the sum over periods is replaced by one period, and the map's mean by brute force.
  const Surface surface = random_surface(6, 6, Interpolation::bilinear);
  const Oracle oracle(surface);
  const auto density = [&](double sigma) {
    return oracle.evaluate(texel_query(surface, {1, 2}, sigma, sigma, 0, {0.2, 0.1}, 0.02)).density;
  };
  EXPECT_NEAR(density(7), density(30), 1e-9 * density(30));
  EXPECT_NE(density(6.5), density(30));
  double mean = 0;
  const int fine = 400;
  for (int k = 0; k < fine * fine; ++k) {
    const int i = k % fine, j = k / fine;
    const Eigen::Vector2d u(6.0 * (i + 0.5) / fine, 6.0 * (j + 0.5) / fine);
    mean += gaussian(normal_at(surface, u) - Eigen::Vector2d(0.2, 0.1), 4e-4 * Eigen::Matrix2d::Identity());
  }
  EXPECT_NEAR(density(30), mean / fine / fine, 2e-3 * density(30));
}

TEST(Oracle, IntegratesToOneOverTheNormals) {
  for (const Interpolation interpolation :
       {Interpolation::nearest, Interpolation::bilinear, Interpolation::bicubic}) {
    const Surface surface = random_surface(16, 16, interpolation, 0.2);
    std::vector<Query> queries;
    const int side = 26;
    for (int k = 0; k < side * side; ++k) {  // the sum over a grid of a smooth function is its integral
      const int i = k % side, j = k / side;
      const Eigen::Vector2d s(-1 + 2 * (i + 0.5) / side, -1 + 2 * (j + 0.5) / side);
      queries.push_back(texel_query(surface, {3, 4}, 1.5, 0.8, 1.2, s, 0.08));
    }
    double total = 0;
    for (const double density : evaluate(surface, queries)) total += density;
    EXPECT_NEAR(total * 4 / side / side, 1, 1e-8);
  }
}

TEST(Oracle, ToleranceIsKept) {
  const Surface surface = random_surface(32, 32, Interpolation::bilinear, 0.05);
  const Oracle fine(surface, 1e-12), coarse(surface, 1e-3);
  int k = 0;
  for (const double roughness : {1e-4, 1e-3, 0.01, 0.1}) {
    for (const double sigma : {0.05, 1.0, 8.0}) {
      const Query query = texel_query(surface, {3.0 * k, 5.1}, sigma, sigma / 5, k, {0.1, -0.04}, roughness);
      ++k;
      const double reference = fine.evaluate(query).density;
      expect_near_relative(Oracle(surface).evaluate(query), reference, 1e-9);
      const OracleResult rough = coarse.evaluate(query);
      EXPECT_NEAR(rough.density, reference, 1e-3 * reference);
      EXPECT_LE(std::abs(rough.density - reference), rough.error_estimate);
    }
  }
}

TEST(Oracle, FarFromAllNormalsTheTailKeepsItsDigits) {
  const Surface surface(4, 4, Interpolation::bilinear,
                        std::vector<Eigen::Vector2d>(16, Eigen::Vector2d(0, 0)));
  const Query far = texel_query(surface, {1, 1}, 1, 1, 0, {0.15, 0}, 0.01);  // 15 standard deviations
  expect_near_relative(evaluate(surface, far), std::exp(-112.5) / (2 * kPi * 1e-4), 1e-9);
  const Query beyond = texel_query(surface, {1, 1}, 1, 1, 0, {0.9, 0}, 1e-3);
  EXPECT_EQ(evaluate(surface, beyond).density, 0);
  EXPECT_TRUE(std::isfinite(evaluate(surface, beyond).error_estimate));
}

TEST(Oracle, IsTheSameForAnyNumberOfThreads) {
  const Surface surface = random_surface(64, 64, Interpolation::bilinear, 0.1);
  std::vector<Query> queries;
  for (int k = 0; k < 200; ++k) {
    queries.push_back(texel_query(surface, {64 * random_number(2, k), 64 * random_number(3, k)}, 0.1 + k % 7,
                                  0.3, k, {0.2 * random_number(4, k), -0.1}, 0.01));
  }
  const std::vector<double> parallel = evaluate(surface, queries);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(evaluate(surface, queries), parallel);
}

TEST(Oracle, RefusesWhatHasNoAnswer) {
  const Surface surface = random_surface(4, 4, Interpolation::bilinear);
  const Query good = texel_query(surface, {1, 1}, 1, 1, 0, {0, 0}, 0.1);
  const auto refuses = [&](auto change) {
    Query query = good;
    change(&query);
    EXPECT_THROW(evaluate(surface, query), UsageError);
  };
  refuses([](Query* q) { q->roughness = 0; });
  refuses([](Query* q) { q->roughness = -0.1; });
  refuses([](Query* q) { q->roughness = std::nan(""); });
  refuses([](Query* q) { q->roughness = 1e-30; });
  refuses([](Query* q) { q->half_vector.x() = INFINITY; });
  refuses([](Query* q) { q->footprint.mean_uv.y() = std::nan(""); });
  refuses([](Query* q) { q->footprint.cov_uv.setZero(); });
  refuses([](Query* q) { q->footprint.cov_uv << 1, 2, 2, 1; });
  refuses([](Query* q) { q->footprint.cov_uv << 1, 0.5, 0.1, 1; });
  refuses([](Query* q) { q->footprint.cov_uv *= 1e300; });
  EXPECT_THROW(Oracle(surface, 0), UsageError);
  EXPECT_THROW(Oracle(surface, std::nan("")), UsageError);

  Query bad = good;
  bad.roughness = 0;
  try {
    Oracle(surface).evaluate(std::vector<Query>{good, bad, good});
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_EQ(std::string(error.what()).rfind("query 1: ", 0), 0u) << error.what();
  }
}

}  // namespace
}  // namespace mica::host::reference::oracle_test
