#include "host/reference/triangle_rule.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "host/reference/several_cpus.h"

namespace mica::host::reference {
namespace {

constexpr int kPackPoints = 8;
constexpr int kPackSize = 7 * kPackPoints;
constexpr double kErrorFactor = 4;  ///< in front of the bound at difficulty()

struct Rule1D {
  Eigen::ArrayXd nodes, weights;  ///< on [0, 1]; the weights add up to 1
};

/// Gauss points of the weight x^beta on [0, 1], beta 0 (Legendre) or 1 (Jacobi): the eigenvalues of the
/// matrix of the three-term recurrence [Golub and Welsch 1969].
Rule1D gauss_rule(int n, int beta) {
  Eigen::VectorXd diagonal(n), off_diagonal(std::max(n - 1, 0));
  for (int k = 0; k < n; ++k) {
    diagonal[k] = beta == 0 ? 0.0 : 1.0 / ((2.0 * k + 1) * (2.0 * k + 3));
    const double m = k + 1;
    const double square = beta == 0 ? m * m / (4 * m * m - 1) : m * (m + 1) / ((2 * m + 1) * (2 * m + 1));
    if (k + 1 < n) off_diagonal[k] = std::sqrt(square);
  }
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
  solver.computeFromTridiagonal(diagonal, off_diagonal);
  return {0.5 * (1 + solver.eigenvalues().array()),
          solver.eigenvectors().row(0).array().square().transpose()};
}

/// exp(x) for x <= 0 to 4e-16, and at least 1e-307, in a form that compilers turn into vector instructions.
inline double exp_of_negative(double x) {
  x = x < -706 ? -706 : x;
  const double shifter = 0x1.8p52;  // added, it leaves the rounded integer in the low bits
  const double shifted = x * 0x1.71547652b82fep0 + shifter;
  const double k = shifted - shifter;
  const double r = (x - k * 0x1.62e42fefa39efp-1) - k * 0x1.abc9e3b39803fp-56;
  double p = 1.0 / 479001600;
  for (const double c : {1.0 / 39916800, 1.0 / 3628800, 1.0 / 362880, 1.0 / 40320, 1.0 / 5040, 1.0 / 720,
                         1.0 / 120, 1.0 / 24, 1.0 / 6, 0.5, 1.0, 1.0}) {
    p = p * r + c;
  }
  std::uint64_t bits;
  std::memcpy(&bits, &shifted, sizeof bits);
  bits = (bits + 1023) << 52;
  double power_of_two;
  std::memcpy(&power_of_two, &bits, sizeof power_of_two);
  return p * power_of_two;
}

MICA_FOR_SEVERAL_CPUS
double weighted_sum(const double* packs, const double* end, const double* exponent) {
  double sums[kPackPoints] = {};
  for (; packs != end; packs += kPackSize) {
    for (int i = 0; i < kPackPoints; ++i) {
      double x = 0;
      for (int k = 0; k < 6; ++k) x += exponent[k] * packs[k * kPackPoints + i];
      sums[i] += packs[6 * kPackPoints + i] * exp_of_negative(x);
    }
  }
  return ((sums[0] + sums[1]) + (sums[2] + sums[3])) + ((sums[4] + sums[5]) + (sums[6] + sums[7]));
}

}  // namespace

TriangleRule::TriangleRule(int points_a_side) : points_a_side_(points_a_side) {
  const int n = points_a_side;
  const Rule1D outward = gauss_rule(n, 1), along = gauss_rule(n, 0);
  const int packs = (n * n + kPackPoints - 1) / kPackPoints;
  packs_.assign(packs * kPackSize, 0.0);
  for (int p = 0; p < n * n; ++p) {
    const double a = outward.nodes[p / n], b = along.nodes[p % n];
    const double l0 = 1 - a, l1 = a * (1 - b), l2 = a * b;
    const double values[7] = {l0 * l0,
                              l1 * l1,
                              l2 * l2,
                              2 * l0 * l1,
                              2 * l0 * l2,
                              2 * l1 * l2,
                              outward.weights[p / n] * along.weights[p % n]};
    double* pack = packs_.data() + p / kPackPoints * kPackSize + p % kPackPoints;
    for (int k = 0; k < 7; ++k) pack[k * kPackPoints] = values[k];
  }
}

double TriangleRule::mean(const Gram& gram) const {
  double exponent[6];
  for (int k = 0; k < 6; ++k) exponent[k] = -0.5 * gram[k];
  return weighted_sum(packs_.data(), packs_.data() + packs_.size(), exponent);
}

TriangleRules::TriangleRules() {
  for (int digits = 0; digits <= max_digits; ++digits) tolerances_[digits] = std::pow(10.0, -digits);
  for (const int n : {2, 4, 5, 6, 8, 10, 12, 16}) {  // 1, 3 and 7 fill no fewer packs than the next
    rules_.emplace_back(n);
    limits_.emplace_back();
    for (int digits = 0; digits <= max_digits; ++digits) {
      limits_.back()[digits] = 8 * n * std::pow(tolerances_[digits] / kErrorFactor, 1.0 / (2 * n));
    }
  }
}

}  // namespace mica::host::reference
