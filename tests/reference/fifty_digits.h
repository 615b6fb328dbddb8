#pragma once

#include <algorithm>
#include <array>
#include <boost/math/constants/constants.hpp>
#include <boost/math/quadrature/gauss.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <vector>

#include "host/reference/query_frame.h"

namespace mica::host::reference {

/// Integrals in 50-digit arithmetic, by another way than the oracle's: across the triangle's lines by the
/// normal tail, along them by composite Gauss quadrature with twice as many panels as a first answer needed.
class FiftyDigits {
 public:
  using Number = boost::multiprecision::cpp_bin_float_50;

  /// Mean of exp(-|w|^2 / 2) over a triangle in R^4.
  static Number mean(const std::array<Whitened, 3>& triangle) {
    std::array<Vector, 3> w;
    for (int i = 0; i < 3; ++i) std::copy(triangle[i].data(), triangle[i].data() + 4, w[i].begin());
    return mean(w);
  }
  using Vector = std::array<Number, 4>;
  /// Integral of exp(-t^2/2) from x >= 0 on, to 1e-40 of itself: Taylor's series of Mills' ratio R around the
  /// nearest node, where R' = x R - 1 gives (n + 1) r[n + 1] = x r[n] + r[n - 1]. Five times as fast as erfc.
  static Number tail(const Number& x) {
    static const std::vector<Number> ratios = mills_ratios();
    if (x >= kLastUnit) return 0;
    const int nearest = static_cast<int>(kNodesAUnit * static_cast<double>(x) + 0.5);
    const Number node = Number(nearest) / kNodesAUnit, step = x - node;
    Number before = ratios[nearest], coefficient = node * before - 1, power = step;
    Number sum = before + coefficient * power;
    for (int n = 1; abs(before * power) > 1e-41 * sum || n < 4; ++n) {
      Number next = (node * coefficient + before) / (n + 1);
      before = coefficient, coefficient = next, power *= step;
      sum += coefficient * power;
    }
    return exp(-x * x / 2) * sum;
  }

  static Number mean(const std::array<Vector, 3>& w) {
    std::array<Number, 4> x_axis = minus(w[1], w[0]), y_axis = minus(w[2], w[0]);
    scale(&x_axis, 1 / sqrt(dot(x_axis, x_axis)));
    subtract(&y_axis, x_axis, dot(x_axis, y_axis));
    scale(&y_axis, 1 / sqrt(dot(y_axis, y_axis)));
    std::array<Number, 4> rest = w[0];
    subtract(&rest, x_axis, dot(x_axis, rest));
    subtract(&rest, y_axis, dot(y_axis, rest));

    std::array<Point, 3> p;
    for (int i = 0; i < 3; ++i) p[i] = {dot(x_axis, w[i]), dot(y_axis, w[i])};
    const Number area =
        abs((p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[2].x - p[0].x) * (p[1].y - p[0].y)) / 2;
    return exp(-dot(rest, rest) / 2) * planar_integral(p) / area;
  }

 private:
  struct Point {
    Number x, y;
  };

  static Number dot(const Vector& a, const Vector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
  }
  static Vector minus(Vector a, const Vector& b) {
    subtract(&a, b, 1);
    return a;
  }
  static void subtract(Vector* a, const Vector& b, const Number& factor) {
    for (int k = 0; k < 4; ++k) (*a)[k] -= factor * b[k];
  }
  static void scale(Vector* a, const Number& factor) {
    for (Number& component : *a) component *= factor;
  }

  /// Integral of exp(-y^2/2) from a to b >= a, with the digits of both tails.
  static Number across(const Number& a, const Number& b) {
    if (a > 0) return tail(a) - tail(b);
    if (b < 0) return tail(-b) - tail(-a);
    return boost::math::constants::root_two_pi<Number>() - tail(-a) - tail(b);
  }

  static constexpr int kNodesAUnit = 16, kLastUnit = 24;  // the tail from 24 on is below 1e-126

  /// Mills' ratio exp(x^2/2) * tail(x) at the nodes.
  static std::vector<Number> mills_ratios() {
    std::vector<Number> ratios;
    for (int n = 0; n <= kNodesAUnit * kLastUnit; ++n) {
      const Number x = Number(n) / kNodesAUnit;
      ratios.push_back(exp(x * x / 2) * boost::math::constants::root_half_pi<Number>() *
                       erfc(x / sqrt(Number(2))));
    }
    return ratios;
  }

  static Number planar_integral(std::array<Point, 3> p) {
    std::sort(p.begin(), p.end(), [](const Point& a, const Point& b) { return a.x < b.x; });
    const auto on_line = [](const Point& a, const Point& b, const Number& x) -> Number {
      return a.y + (b.y - a.y) * (x - a.x) / (b.x - a.x);
    };
    const auto integrand = [&](const Number& x) -> Number {
      const Number base = on_line(p[0], p[2], x);
      const Number side = x < p[1].x ? on_line(p[0], p[1], x) : on_line(p[1], p[2], x);
      return exp(-x * x / 2) * across(std::min(base, side), std::max(base, side));
    };
    return along(integrand, p[0].x, p[1].x) + along(integrand, p[1].x, p[2].x);
  }

  /// Composite Gauss quadrature by bisection; the tails beyond |x| = 20 are below 1e-87.
  template <typename F>
  static Number along(const F& f, Number a, Number b) {
    a = std::max(a, Number(-20));
    b = std::min(b, Number(20));
    if (!(a < b)) return 0;
    const Number whole = panel(f, a, b);
    return refine(f, a, b, whole, 0);
  }
  template <typename F>
  static Number panel(const F& f, const Number& a, const Number& b) {
    return boost::math::quadrature::gauss<Number, 15>::integrate(f, a, b);
  }
  template <typename F>
  static Number refine(const F& f, const Number& a, const Number& b, const Number& whole,
                       const Number& so_far) {
    const Number middle = (a + b) / 2, left = panel(f, a, middle), right = panel(f, middle, b);
    const Number scale = std::max(Number(left + right), so_far);
    // Halving a rule of 15 points gains a factor of 2^30: what is left of a difference of 1e-12 is below
    // 1e-20. Where a panel is wide enough to miss a peak, two rules may agree and both be wrong.
    if (b - a < 4 && abs(left + right - whole) <= Number(1e-12) * scale) return left + right;
    const Number done = refine(f, a, middle, left, so_far);
    return done + refine(f, middle, b, right, std::max(so_far, done));
  }
};

}  // namespace mica::host::reference
