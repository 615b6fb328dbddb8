#pragma once

#include <array>
#include <vector>

namespace mica::host::reference {

/// A Gaussian's exponent over a triangle: q = lambda^T G lambda at barycentric coordinates lambda, where G
/// holds the inner products of the three whitened vertices, in the order G00, G11, G22, G01, G02, G12.
using Gram = std::array<double, 6>;

/// Gauss quadrature over a triangle: n Gauss-Jacobi points from a vertex to the opposite edge times n
/// Gauss-Legendre points along that edge. All weights are positive; polynomials of degree 2n - 1 are
/// integrated exactly.
class TriangleRule {
 public:
  explicit TriangleRule(int points_a_side);

  int points_a_side() const { return points_a_side_; }

  /// Mean of exp(-q/2) over a triangle; where q > 1412 it is taken for 1412.
  double mean(const Gram& gram) const;

 private:
  int points_a_side_;
  std::vector<double>
      packs_;  ///< packs of 8 points: their products of barycentric coordinates, then their weights
};

/// The rules in use, from few points to many, and how difficult a triangle each of them bears.
///
/// Along every chord of a triangle the integrand is a constant times exp(-b x - d^2 x^2 / 2), 0 <= x <= 1. A
/// triangle's `slope` is an upper bound of |b|, wherever on the chord x = 0 is put, and its `diameter` one of
/// d.
class TriangleRules {
 public:
  static constexpr int max_digits = 13;

  TriangleRules();

  int count() const { return static_cast<int>(rules_.size()); }
  const TriangleRule& rule(int index) const { return rules_[index]; }

  /// A rule keeps a tolerance of 10^-digits relative to the mean where difficulty(n, slope, diameter) is at
  /// most this.
  /// @param digits 0 ... max_digits
  double limit(int index, int digits) const { return limits_[index][digits]; }
  const double* limits(int index) const { return limits_[index].data(); }
  /// 10^-digits
  double tolerance(int digits) const { return tolerances_[digits]; }

 private:
  std::vector<TriangleRule> rules_;
  std::array<double, max_digits + 1> tolerances_;
  std::vector<std::array<double, max_digits + 1>> limits_;
};

}  // namespace mica::host::reference
