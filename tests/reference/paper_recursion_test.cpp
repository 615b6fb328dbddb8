#include "bench/paper_recursion.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "bench/paper_triangle.h"
#include "host/base/error_norms.h"
#include "host/base/random.h"
#include "host/reference/oracle.h"
#include "mica/error.h"

// A baseline is honest only if it computes what it claims to: the paper's algorithm is held to the oracle
// here, to the accuracy that the paper's erf allows.
namespace mica::host::bench::paper_recursion_test {
namespace {

/// Integral of exp(-Q/2) over the unit right triangle by midpoints of a fine lattice.
double brute_force(const Quadratic& q) {
  constexpr int n = 250;
  const auto value = [&](double u, double v) {
    return std::exp(-0.5 * (q.a * u * u + 2 * q.b * u * v + q.c * v * v + 2 * q.d * u + 2 * q.e * v + q.f));
  };
  double sum = 0;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i + j < n; ++i) {
      sum += value((i + 1.0 / 3) / n, (j + 1.0 / 3) / n);
      if (i + j + 1 < n) sum += value((i + 2.0 / 3) / n, (j + 2.0 / 3) / n);
    }
  }
  return 0.5 * sum / n / n;
}

TEST(PaperTriangle, IsWithinTheErrorOfTheErf) {
  for (const double width : {30.0, 1.0, 0.3, 0.1, 0.03}) {
    for (int k = 0; k < 30; ++k) {
      // Q of a Gaussian around (x, y) with two standard deviations and a direction.
      const double x = 2 * random_unit(3, 0, k) - 0.5, y = 2 * random_unit(3, 1, k) - 0.5;
      const Eigen::Matrix2d turn = Eigen::Rotation2D<double>(6.3 * random_unit(3, 2, k)).toRotationMatrix();
      const Eigen::Vector2d inverse_variances(1 / (width * width), 0.2 / (width * width));
      const Eigen::Matrix2d p = turn * inverse_variances.asDiagonal() * turn.transpose();
      const Eigen::Vector2d mean(x, y), linear = -p * mean;
      const Quadratic q{p(0, 0), p(0, 1), p(1, 1), linear.x(), linear.y(), mean.dot(p * mean)};
      // The six quadratics are off by at most 0.0082, and their slopes by 0.098; the latter bounds wide
      // Gaussians, of which a triangle sees a small difference of two values.
      const double allowed =
          std::min(2 * 0.0082 / std::sqrt(0.5 * q.c), 0.5 * 0.098) * std::sqrt(3.14159) / 2;
      EXPECT_NEAR(integrate_paper_triangle(q), brute_force(q), allowed + 1e-5) << width << ' ' << k;
    }
  }
}

Surface waves(int width, int height) {
  std::vector<Eigen::Vector2d> normals;
  for (int j = 0; j < height; ++j) {
    for (int i = 0; i < width; ++i) {
      const double x = 6.283185307 * i / width, y = 6.283185307 * j / height;
      normals.emplace_back(0.1 * std::sin(5 * x + 2 * y) + 0.05 * std::cos(9 * y),
                           0.1 * std::cos(3 * x - 7 * y) + 0.05 * std::sin(8 * x));
    }
  }
  return Surface(width, height, Interpolation::bilinear, std::move(normals));
}

class Recursion : public testing::TestWithParam<std::tuple<double, double, double>> {};

TEST_P(Recursion, AgreesWithTheOracle) {
  const auto [sigma_texels, aspect, roughness] = GetParam();
  const Surface surface = waves(96, 64);  // no powers of two, and footprints across the seam
  const Eigen::Matrix2d turn = Eigen::Rotation2D<double>(0.7).toRotationMatrix();
  const Eigen::Vector2d variances(sigma_texels * sigma_texels, std::pow(sigma_texels / aspect, 2));
  const Eigen::Vector2d to_uv(1.0 / 96, 1.0 / 64);
  std::vector<Query> queries(40);
  for (std::size_t k = 0; k < queries.size(); ++k) {
    Query& query = queries[k];
    query.footprint.mean_uv = {2 * random_unit(4, 0, k), 2 * random_unit(4, 1, k)};
    query.footprint.cov_uv =
        to_uv.asDiagonal() * (turn * variances.asDiagonal() * turn.transpose()) * to_uv.asDiagonal();
    query.footprint.cov_uv(1, 0) = query.footprint.cov_uv(0, 1);
    query.half_vector = {0.3 * random_unit(4, 2, k) - 0.15, 0.3 * random_unit(4, 3, k) - 0.15};
    query.roughness = roughness;
  }
  const std::vector<reference::OracleResult> expected = reference::Oracle(surface, 1e-6).evaluate(queries);
  const std::vector<float> densities = PaperRecursion(surface).evaluate(queries);
  RelativeL2 error;
  for (std::size_t k = 0; k < queries.size(); ++k) {
    EXPECT_GE(densities[k], 0);
    error.add(densities[k], expected[k].density);
  }
  ASSERT_TRUE(error.has_reference());
  EXPECT_LT(error.value(), 0.01);
}

INSTANTIATE_TEST_SUITE_P(All, Recursion,
                         testing::Combine(testing::Values(1.0, 4.0, 10.0), testing::Values(1.0, 5.0),
                                          testing::Values(0.005, 0.03, 0.2)));

TEST(PaperRecursion, RefusesOtherSurfaces) {
  EXPECT_THROW(PaperRecursion(Surface(1, 1, Interpolation::nearest, {Eigen::Vector2d(0, 0)})), UsageError);
}

}  // namespace
}  // namespace mica::host::bench::paper_recursion_test
