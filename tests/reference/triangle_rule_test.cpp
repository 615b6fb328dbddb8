#include "host/reference/triangle_rule.h"

#include <gtest/gtest.h>

#include <cmath>

#include "host/reference/triangle_batch.h"

namespace mica::host::reference::triangle_rule_test {
namespace {

double factorial(int n) {
  return std::tgamma(n + 1.0);
}

/// A triangle on which q is linear: q = 2 (c + x l1 + y l2).
Gram gram_of_linear(double c, double x, double y) {
  return {2 * c, 2 * (c + x), 2 * (c + y), 2 * c + x, 2 * c + y, 2 * c + x + y};
}

// The mean of exp(-f) over a triangle with f = f0, f1, f2 at its corners is twice the second divided
// difference of exp(-f), here in closed form for three different values.
double mean_of_exponential(double f0, double f1, double f2) {
  return 2 * (std::exp(-f0) / ((f1 - f0) * (f2 - f0)) + std::exp(-f1) / ((f0 - f1) * (f2 - f1)) +
              std::exp(-f2) / ((f0 - f2) * (f1 - f2)));
}

TEST(TriangleRule, IntegratesExponentialsOfLinearFunctions) {
  for (const int n : {8, 10, 12, 16}) {
    const TriangleRule rule(n);
    EXPECT_NEAR(rule.mean(gram_of_linear(1, 1, 3)), mean_of_exponential(1, 2, 4), 1e-14) << n;
    EXPECT_NEAR(rule.mean(gram_of_linear(2, 2, -1)), mean_of_exponential(2, 4, 1), 1e-14) << n;
  }
}

TEST(TriangleRule, IsExactToItsDegree) {
  // The mean of exp(-e f) is a power series in e whose terms are moments of the triangle; with q = 2 e f, f =
  // l1 + 2 l2, the series of the rule and of the exact mean first differ at degree 2n, so for small e by a
  // multiple of e^(2n).
  for (const int n : {1, 2, 3}) {
    const TriangleRule rule(n);
    const auto error = [&](double e) {
      long double exact = 0;  // sum of (-e)^k / k! times the mean of f^k = 2 k!/(k+2)! h_k(0, 1, 2)
      for (int k = 0; k < 30; ++k) {
        long double h = 0;
        for (int j = 0; j <= k; ++j) h += std::pow(2.0L, j);
        exact +=
            std::pow(-static_cast<long double>(e), k) * 2 * h / static_cast<long double>(factorial(k + 2));
      }
      return std::abs(rule.mean(gram_of_linear(0, e, 2 * e)) - static_cast<double>(exact));
    };
    EXPECT_LT(error(0.25), 1.4 * std::pow(0.5, 2 * n) * error(0.5)) << n;
    EXPECT_GT(error(0.5), 1e-14) << n;
  }
}

TEST(TriangleRule, VanishesFarOff) {
  for (const double q : {1300.0, 1400.0, 1500.0, 1e5, 1e300}) {
    const double mean = TriangleRule(4).mean({q, q, q, q, q, q});
    EXPECT_NEAR(mean, std::exp(-0.5 * q), 1e-13 * std::exp(-0.5 * q) + 1e-306) << q;
  }
}

TEST(TriangleRules, KeepTheirTolerance) {
  // Triangles of many sizes, shapes and distances, against 32 x 32 points.
  const TriangleRules rules;
  const TriangleRule fine(32);
  int chosen = 0;
  for (int k = 0; k < 4000; ++k) {
    const double size = 0.01 * std::pow(300.0, (k % 61) / 60.0), far = (k % 37) / 4.0, turn = k * 0.7,
                 thin = std::pow(0.01, (k % 5) / 4.0);
    std::array<Whitened, 3> v;
    for (int i = 0; i < 3; ++i) {
      const double angle = turn + 2.1 * i + 0.3 * std::sin(k + i);
      v[i] = {far + size * std::cos(angle), thin * size * std::sin(angle), 0.3 * size * std::sin(2 * angle),
              0.2};
    }
    const Gram gram = gram_of(v);
    const double exact = fine.mean(gram);
    for (const int digits : {1, 3, 6, 9, 12}) {
      const int rule = choose_rule(rules, gram, digits);
      if (rule == rules.count()) continue;
      ++chosen;
      EXPECT_NEAR(rules.rule(rule).mean(gram), exact, exact * (rules.tolerance(digits) + 2e-14))
          << k << ' ' << digits;
    }
  }
  EXPECT_GT(chosen, 10000);
}

}  // namespace
}  // namespace mica::host::reference::triangle_rule_test
