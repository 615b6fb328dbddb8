// The oracle against 50-digit quadrature of whole queries, from the query's own numbers on. Cases are 60, or
// as many as the environment's MICA_ORACLE_CASES says: 10,000 take half an hour of one core.
#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "host/base/constants.h"
#include "host/base/random.h"
#include "host/reference/oracle.h"
#include "host/surface/interpolate.h"
#include "tests/reference/fifty_digits.h"

namespace mica::host::reference::oracle_fifty_digits_test {
namespace {

using Number = FiftyDigits::Number;

constexpr int kSide = 8;

double random(std::uint64_t n, std::uint64_t stream) {
  return random_unit(50, stream, n);
}
double logarithmic(std::uint64_t n, std::uint64_t stream, double low, double high) {
  return low * std::pow(high / low, random(n, stream));
}

/// Independent normals a texel: wide triangles, mirrored and thin ones.
Surface random_surface(std::uint64_t n) {
  std::vector<Eigen::Vector2d> normals;
  const double range = logarithmic(n, 0, 1e-3, 0.5);
  for (std::uint64_t k = 0; k < kSide * kSide; ++k)
    normals.emplace_back(0.1 + range * (random(n, 100 + 2 * k) - 0.5),
                         range * (random(n, 101 + 2 * k) - 0.5));
  return Surface(kSide, kSide, Interpolation::bilinear, std::move(normals));
}

/// A footprint of 0.01 to 0.3 texels anywhere, and a half vector up to five roughnesses from a normal near
/// it.
Query random_query(const Surface& surface, std::uint64_t n) {
  Query query;
  query.footprint.mean_uv = {random(n, 1), random(n, 2)};
  const double major = logarithmic(n, 3, 0.01, 0.3) / kSide, minor = major * logarithmic(n, 4, 0.03, 1);
  const double angle = kPi * random(n, 5), c = std::cos(angle), s = std::sin(angle);
  const double off_diagonal = (major * major - minor * minor) * c * s;
  query.footprint.cov_uv << major * major * c * c + minor * minor * s * s, off_diagonal, off_diagonal,
      major * major * s * s + minor * minor * c * c;
  query.roughness = logarithmic(n, 6, 1e-3, 0.3);
  const double around = 2 * kPi * random(n, 7);
  const Eigen::Vector2d near = normal_at(surface, kSide * query.footprint.mean_uv);
  query.half_vector =
      near + 3 * random(n, 8) * query.roughness * Eigen::Vector2d(std::cos(around), std::sin(around));
  return query;
}

/// D of a query by its definition, triangle by triangle.
class FiftyDigitDensity {
 public:
  FiftyDigitDensity(const Surface& surface, const Query& query) : surface_(surface), query_(query) {
    const Number side = kSide;
    a_ = Number(query.footprint.cov_uv(0, 0)) * side * side;
    b_ = Number(query.footprint.cov_uv(0, 1)) * side * side;
    c_ = Number(query.footprint.cov_uv(1, 1)) * side * side;
    mean_x_ = Number(query.footprint.mean_uv.x()) * side,
    mean_y_ = Number(query.footprint.mean_uv.y()) * side;
    root_a_ = sqrt(a_), root_rest_ = sqrt(c_ - b_ * b_ / a_);
  }

  Number density() const {
    std::vector<Triangle> triangles = triangles_in_reach();
    std::sort(triangles.begin(), triangles.end(),
              [](const Triangle& a, const Triangle& b) { return a.nearest < b.nearest; });
    Number sum = 0;
    for (std::size_t n = 0; n < triangles.size(); ++n) {
      const double left = 0.5 * static_cast<double>(triangles.size() - n) *
                          std::exp(-0.5 * triangles[n].nearest * triangles[n].nearest);
      if (left < 1e-15 * static_cast<double>(sum)) break;
      sum += FiftyDigits::mean(triangles[n].corners) / 2;
    }
    const Number two_pi = boost::math::constants::two_pi<Number>(), roughness = query_.roughness;
    return sum / (two_pi * two_pi * root_a_ * root_rest_ * roughness * roughness);
  }

 private:
  struct Triangle {
    std::array<FiftyDigits::Vector, 3> corners;
    double nearest;  ///< lower bound of |w|
  };

  FiftyDigits::Vector corner(long i, long j) const {
    const Eigen::Vector2d& normal = surface_.texel(i, j);
    const Number x = Number(i) + Number(0.5) - mean_x_, y = Number(j) + Number(0.5) - mean_y_;
    const Number roughness = query_.roughness;
    // Cholesky's factor of the covariance.
    return {x / root_a_, (y - b_ / a_ * x) / root_rest_,
            (Number(normal.x()) - Number(query_.half_vector.x())) / roughness,
            (Number(normal.y()) - Number(query_.half_vector.y())) / roughness};
  }

  std::vector<Triangle> triangles_in_reach() const {
    const double x = static_cast<double>(mean_x_), y = static_cast<double>(mean_y_);
    const long reach = 2 + static_cast<long>(12 * std::sqrt(static_cast<double>(a_ + c_)));
    std::vector<Triangle> triangles;
    for (long j = static_cast<long>(y) - reach; j <= static_cast<long>(y) + reach; ++j) {
      for (long i = static_cast<long>(x) - reach; i <= static_cast<long>(x) + reach; ++i) {
        for (const long half : {0L, 1L}) {
          Triangle triangle{{corner(i + half, j + half), corner(i + 1, j), corner(i, j + 1)}, 0};
          triangle.nearest = nearest(triangle.corners);
          triangles.push_back(triangle);
        }
      }
    }
    return triangles;
  }

  /// Distance of the triangle from the origin, by the region of its plane that the origin lies over.
  static double nearest(const std::array<FiftyDigits::Vector, 3>& corners) {
    std::array<Eigen::Vector4d, 3> w;
    for (int n = 0; n < 3; ++n)
      for (int k = 0; k < 4; ++k) w[n][k] = static_cast<double>(corners[n][k]);
    double least = std::min({of_edge(w[0], w[1]), of_edge(w[1], w[2]), of_edge(w[2], w[0])});
    const Eigen::Vector4d e1 = w[1] - w[0], e2 = w[2] - w[0];
    const double g11 = e1.dot(e1), g12 = e1.dot(e2), g22 = e2.dot(e2), r1 = -e1.dot(w[0]), r2 = -e2.dot(w[0]);
    const double determinant = g11 * g22 - g12 * g12;
    const double l1 = (g22 * r1 - g12 * r2) / determinant, l2 = (g11 * r2 - g12 * r1) / determinant;
    if (l1 > 0 && l2 > 0 && l1 + l2 < 1) least = std::min(least, (w[0] + l1 * e1 + l2 * e2).norm());
    return 0.999 * least;
  }
  static double of_edge(const Eigen::Vector4d& a, const Eigen::Vector4d& b) {
    const Eigen::Vector4d edge = b - a;
    return (a + std::clamp(-a.dot(edge) / edge.squaredNorm(), 0.0, 1.0) * edge).norm();
  }

  const Surface& surface_;
  const Query& query_;
  Number a_, b_, c_, mean_x_, mean_y_, root_a_, root_rest_;
};

TEST(OracleFiftyDigits, TailsAreThoseOfTheErrorFunction) {
  for (std::uint64_t n = 0; n < 500; ++n) {
    const Number x = n == 0 ? 0.0 : 24 * random(n, 1000),
                 root_half_pi = boost::math::constants::root_half_pi<Number>();
    const Number expected = root_half_pi * erfc(x / sqrt(Number(2)));
    EXPECT_LE(abs(FiftyDigits::tail(x) / expected - 1), 1e-38) << x;
  }
}

TEST(OracleFiftyDigits, AgreesToTwelve) {
  const char* const wanted = std::getenv("MICA_ORACLE_CASES");
  const std::size_t cases = wanted ? std::strtoul(wanted, nullptr, 10) : 60;
  std::vector<double> errors(cases, 0.0), claims(cases, 0.0);
  tbb::parallel_for(std::size_t{0}, cases, [&](std::size_t n) {
    const Surface surface = random_surface(n);
    const Query query = random_query(surface, n);
    const OracleResult result = Oracle(surface, 1e-12).evaluate(query);
    const Number expected = FiftyDigitDensity(surface, query).density();
    errors[n] = static_cast<double>(abs(Number(result.density) - expected) / expected);
    claims[n] = result.error_estimate / result.density;
  });
  std::size_t worst = 0;
  for (std::size_t n = 0; n < cases; ++n) {
    EXPECT_LE(errors[n], 1e-12) << "case " << n << ", claimed " << claims[n];
    if (errors[n] > errors[worst]) worst = n;
  }
  std::printf("%zu cases, largest relative error %.2e (case %zu, where the oracle claims %.2e)\n", cases,
              errors[worst], worst, claims[worst]);
}

}  // namespace
}  // namespace mica::host::reference::oracle_fifty_digits_test
