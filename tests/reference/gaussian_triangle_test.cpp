#include "host/reference/gaussian_triangle.h"
#include "host/base/constants.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>
#include <random>

#include "tests/reference/fifty_digits.h"

namespace mica::host::reference::gaussian_triangle_test {
namespace {

constexpr double kTolerance = 1e-10;

/// The mean of exp(-|w|^2 / 2) over a triangle, and the error that the oracle claims for it.
struct Mean {
  double value, error;
};
Mean mean(const std::array<Whitened, 3>& triangle, double lower_bound = 0) {
  static const TriangleRules rules;
  RunningIntegral integral(kTolerance, 1);
  if (lower_bound > 0) integral.promise(lower_bound);
  integrate_triangle(triangle, 1, rules, &integral);
  return {integral.sum(), integral.error()};
}

std::array<Whitened, 3> planar(double x0, double y0, double x1, double y1, double x2, double y2) {
  return {Whitened(x0, y0, 0, 0), Whitened(x1, y1, 0, 0), Whitened(x2, y2, 0, 0)};
}

/// An orthonormal frame of R^4, so that nothing is aligned with the axes.
Eigen::Matrix4d turned(std::mt19937* random) {
  std::normal_distribution<double> normal;
  Eigen::Matrix4d m;
  for (double& entry : m.reshaped()) entry = normal(*random);
  return m.householderQr().householderQ();
}

struct Regime {
  const char* name;
  double size, thickness;   // size and thickness of the triangle, whitened
  double distance, offset;  // how far its nearest point or corner is within its plane, and the plane
};

class GaussianTriangle : public testing::TestWithParam<Regime> {};

TEST_P(GaussianTriangle, AgreesWithFiftyDigits) {
  const Regime& regime = GetParam();
  std::mt19937 random(static_cast<unsigned>(regime.size + 10 * regime.distance));
  std::uniform_real_distribution<double> uniform;
  const Eigen::Matrix4d frame = turned(&random);
  const double apex = regime.size * (1.3 * uniform(random) - 0.2),
               start = -regime.size * 0.6 * uniform(random);
  const double turn = 2 * kPi * uniform(random);
  std::array<Whitened, 3> triangle = planar(start, 0, start + regime.size, 0, start + apex, regime.thickness);
  for (Whitened& w : triangle) {
    const double x = w.x(), y = w.y() + regime.distance;
    w = frame * Whitened(x * std::cos(turn) - y * std::sin(turn), x * std::sin(turn) + y * std::cos(turn),
                         regime.offset, 0);
  }
  const double expected = static_cast<double>(FiftyDigits::mean(triangle));
  const double rounding = 1e-14 * (1 + regime.size);  // what the vertices themselves are rounded by
  const Mean alone = mean(triangle);
  EXPECT_NEAR(alone.value, expected, (kTolerance + rounding) * expected);
  EXPECT_LE(std::abs(alone.value - expected), alone.error + rounding * expected);
  const Mean amid_others = mean(triangle, 0.5 * expected);
  EXPECT_NEAR(amid_others.value, expected, (3 * kTolerance + rounding) * expected);
}

INSTANTIATE_TEST_SUITE_P(
    Regimes, GaussianTriangle,
    testing::Values(Regime{"tiny", 1e-4, 1e-4, 0.5, 0.2}, Regime{"tiny far", 1e-3, 1e-3, 8, 0.2},
                    Regime{"small", 0.3, 0.2, 0.4, 0}, Regime{"unit", 1, 1, -0.3, 0.5},
                    Regime{"unit far", 1, 1, 7, 0}, Regime{"few", 5, 4, -1, 1}, Regime{"few far", 5, 4, 6, 2},
                    Regime{"edge", 50, 30, 0, 0}, Regime{"wide", 300, 200, -3, 1},
                    Regime{"wide near miss", 300, 200, 2, 1}, Regime{"wide far", 300, 200, 9, 1},
                    Regime{"huge", 1e5, 1e5, 1, 2}, Regime{"needle", 30, 1e-3, -5e-4, 0},
                    Regime{"long needle", 1e4, 1e-4, 1, 1}, Regime{"sliver", 100, 0.3, -0.1, 0.5},
                    Regime{"hair", 100, 1e-8, 2, 0}),
    [](const auto& info) {
      std::string name = info.param.name;
      std::replace(name.begin(), name.end(), ' ', '_');
      return name;
    });

TEST(GaussianTriangleClosedForm, DeepInsideIsOne) {
  const auto triangle = planar(-40, -30, 50, -30, 0, 60);
  EXPECT_NEAR(mean(triangle).value * flatten(triangle).area() / (2 * kPi), 1, 1e-14);
  EXPECT_NEAR(normal_probability({Eigen::Vector2d(-40, -30), {50, -30}, {0, 60}}), 1, 1e-15);
}

TEST(GaussianTriangleClosedForm, HalfThroughAnEdgeQuarterAtARightAngleEighthAtADiagonal) {
  EXPECT_NEAR(normal_probability({Eigen::Vector2d(-90, 0), {80, 0}, {5, 70}}), 0.5, 1e-15);
  EXPECT_NEAR(normal_probability({Eigen::Vector2d(0, 0), {80, 0}, {0, 70}}), 0.25, 1e-15);
  EXPECT_NEAR(normal_probability({Eigen::Vector2d(0, 0), {80, 0}, {80, 80}}), 0.125, 1e-15);
  EXPECT_NEAR(normal_probability({Eigen::Vector2d(-90, 1e-300), {80, 0}, {5, 70}}), 0.5, 1e-15);
}

TEST(GaussianTriangleClosedForm, RightTriangleAtTheOriginIsOwensIntegral) {
  // Probability of 0 < x < h, 0 < y < a x is atan(a) / 2pi - T(h, a), and T(h, 1) = Phi(h) (1 - Phi(h)) / 2.
  for (const double h : {0.1, 0.7, 2.5, 6.0}) {
    const double phi = 0.5 * std::erfc(-h / std::sqrt(2.0));
    EXPECT_NEAR(normal_probability({Eigen::Vector2d(0, 0), {h, 0}, {h, h}}), 0.125 - 0.5 * phi * (1 - phi),
                1e-15);
  }
}

TEST(GaussianTriangleClosedForm, PartsAddUp) {
  for (const double size : {0.5, 3.0, 20.0, 500.0}) {
    const Whitened a(-0.4 * size, 0.1, 0.5, -0.2), b(0.7 * size, -0.2 * size, 0.1, 0.3),
        c(0.1, 0.5 * size, -0.4, 0.2);
    const Whitened inner = 0.2 * a + 0.5 * b + 0.3 * c;
    const double parts =
        0.3 * mean({a, b, inner}).value + 0.2 * mean({b, c, inner}).value + 0.5 * mean({c, a, inner}).value;
    const double whole = mean({a, b, c}).value;
    EXPECT_NEAR(parts, whole, 1e-11 * whole) << size;
  }
}

TEST(GaussianTriangleClosedForm, DegenerateTrianglesAreIntegratedOverTheirShadow) {
  // All three corners in one point, and on one line with the middle corner halfway: a triangular density on
  // [-1, 1].
  const Whitened p(0.3, -0.2, 0.1, 0.4);
  EXPECT_NEAR(mean({p, p, p}).value, std::exp(-0.5 * p.squaredNorm()), 1e-15);
  const double expected = std::sqrt(2 * kPi) * std::erf(1 / std::sqrt(2.0)) - 2 * (1 - std::exp(-0.5));
  EXPECT_NEAR(mean(planar(-1, 0, 1, 0, 0, 0)).value, expected, 1e-12);
}

TEST(NearestSquared, OfConvexPolygons) {
  const Eigen::Vector2d square[4] = {{1, 1}, {3, 1}, {3, 3}, {1, 3}};
  EXPECT_DOUBLE_EQ(nearest_squared(square, 4), 2);
  const Eigen::Vector2d beside[4] = {{1, -1}, {3, -1}, {3, 3}, {1, 3}};
  EXPECT_DOUBLE_EQ(nearest_squared(beside, 4), 1);
  const Eigen::Vector2d around[4] = {{-1, -1}, {-1, 3}, {3, 3}, {3, -1}};  // clockwise
  EXPECT_DOUBLE_EQ(nearest_squared(around, 4), 0);
  const Eigen::Vector2d flat[3] = {{5, 0}, {6, 0}, {5.5, 0}};  // points away from the origin
  EXPECT_DOUBLE_EQ(nearest_squared(flat, 3), 25);
}

}  // namespace
}  // namespace mica::host::reference::gaussian_triangle_test
