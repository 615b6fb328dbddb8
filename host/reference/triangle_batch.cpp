#include "host/reference/triangle_batch.h"

#include <algorithm>
#include <cmath>

#include "host/reference/several_cpus.h"

namespace mica::host::reference {
namespace {

using Lanes = double[TriangleBatch::capacity];

MICA_FOR_SEVERAL_CPUS
void bound_cells(const double (*corners)[4][CellBatch::capacity], int count, double* nearest_squared) {
  for (int c = 0; c < count; ++c) {
    double sum = 0;
    for (int k = 0; k < 4; ++k) {
      const double a = corners[0][k][c], b = corners[1][k][c], d = corners[2][k][c], e = corners[3][k][c];
      const double low = std::min(std::min(a, b), std::min(d, e)),
                   high = std::max(std::max(a, b), std::max(d, e));
      const double gap = std::max(std::max(low, -high), 0.0);
      sum += gap * gap;
    }
    nearest_squared[c] = sum;
  }
}

MICA_FOR_SEVERAL_CPUS
void inner_products(const Lanes* a, const Lanes* b, int count, double* product) {
  for (int t = 0; t < count; ++t) {
    product[t] = a[0][t] * b[0][t] + a[1][t] * b[1][t] + a[2][t] * b[2][t] + a[3][t] * b[3][t];
  }
}

inline double spread(double a, double b, double c) {
  return std::max(std::max(a, b), c) - std::min(std::min(a, b), c);
}

/// The slope along an edge from vertex i to j, seen from vertex k, is w_k . (w_j - w_i). It is linear in
/// between, and every chord is a part of a mean of edges.
inline double slope_of(double g00, double g11, double g22, double g01, double g02, double g12) {
  return std::max(std::max(spread(g00, g01, g02), spread(g01, g11, g12)), spread(g02, g12, g22));
}

inline double diameter_squared_of(double g00, double g11, double g22, double g01, double g02, double g12) {
  return std::max(std::max(g00 + g11 - 2 * g01, g00 + g22 - 2 * g02), std::max(g11 + g22 - 2 * g12, 0.0));
}

/// What n points a side make of a triangle; see TriangleRules::limit.
///
/// On a unit chord, n Gauss points err by at most max|f^(2n)| (n!)^4 / ((2n+1) (2n)!^3). There, by Cauchy's
/// estimate, |f^(2n)| <= f (2n)! exp(b r + d^2 r^2 / 2) / r^(2n) for any radius r. The best one is r = 2n /
/// K, K = (b + sqrt(b^2 + 8n d^2)) / 2. As (n!)^4 / (2n)!^2 <= 4n / 16^n, both directions of the product rule
/// err by
///   4 (exp(1 - n d^2 / K^2) K / (8n))^(2n)
/// relative to the largest f on a chord. The bound has slack enough to take it as relative to the mean.
/// n d^2 / K^2 lies in [0, 1/2], and there the convex exponential stays below its chord.
inline double difficulty(double n, double slope, double diameter_squared) {
  const double k = 0.5 * (slope + std::sqrt(slope * slope + 8 * n * diameter_squared)) + 1e-300;
  return k * (2.7183 - 2.1391 * (n * diameter_squared / (k * k)));
}

MICA_FOR_SEVERAL_CPUS
void measure(const Lanes* g, int count, double* slope, double* diameter_squared) {
  for (int t = 0; t < count; ++t) {
    slope[t] = slope_of(g[0][t], g[1][t], g[2][t], g[3][t], g[4][t], g[5][t]);
    diameter_squared[t] = diameter_squared_of(g[0][t], g[1][t], g[2][t], g[3][t], g[4][t], g[5][t]);
  }
}

/// Gives a rule to those triangles that have none yet and that it suits; returns how many still have none.
MICA_FOR_SEVERAL_CPUS
int assign_rule(const TriangleRules& rules, int rule, const double* slope, const double* diameter_squared,
                const int* digits, int count, int* assigned) {
  const double n = rules.rule(rule).points_a_side();
  const double* limits = rules.limits(rule);
  const int none = rules.count();
  int remaining = 0;
  for (int t = 0; t < count; ++t) {
    const bool suits = difficulty(n, slope[t], diameter_squared[t]) <= limits[digits[t]];
    assigned[t] = assigned[t] == none && suits ? rule : assigned[t];
    remaining += assigned[t] == none;
  }
  return remaining;
}

}  // namespace

void CellBatch::bound() {
  bound_cells(corners, count, nearest_squared);
}

void TriangleBatch::push_cell(const CellBatch& cells, int cell, int needed_digits) {
  constexpr int corner_of[2][3] = {{0, 1, 2}, {3, 2, 1}};
  for (const auto& corners : corner_of) {
    for (int vertex = 0; vertex < 3; ++vertex) {
      for (int k = 0; k < 4; ++k) vertices[vertex][k][count] = cells.corners[corners[vertex]][k][cell];
    }
    digits[count++] = needed_digits;
  }
}

void TriangleBatch::choose_rules(const TriangleRules& rules) {
  constexpr int pairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
  for (int k = 0; k < 6; ++k) inner_products(vertices[pairs[k][0]], vertices[pairs[k][1]], count, gram[k]);
  double slope[capacity], diameter_squared[capacity];
  measure(gram, count, slope, diameter_squared);
  std::fill(rule, rule + count, rules.count());
  for (int r = 0; r < rules.count(); ++r) {
    if (assign_rule(rules, r, slope, diameter_squared, digits, count, rule) == 0) break;
  }
}

Gram TriangleBatch::gram_of(int t) const {
  return {gram[0][t], gram[1][t], gram[2][t], gram[3][t], gram[4][t], gram[5][t]};
}

std::array<Whitened, 3> TriangleBatch::vertices_of(int t) const {
  std::array<Whitened, 3> result;
  for (int vertex = 0; vertex < 3; ++vertex) {
    for (int k = 0; k < 4; ++k) result[vertex][k] = vertices[vertex][k][t];
  }
  return result;
}

int choose_rule(const TriangleRules& rules, const Gram& g, int digits) {
  const double slope = slope_of(g[0], g[1], g[2], g[3], g[4], g[5]);
  const double diameter_squared = diameter_squared_of(g[0], g[1], g[2], g[3], g[4], g[5]);
  int r = 0;
  while (r < rules.count() &&
         difficulty(rules.rule(r).points_a_side(), slope, diameter_squared) > rules.limit(r, digits)) {
    ++r;
  }
  return r;
}

Gram gram_of(const std::array<Whitened, 3>& v) {
  return {v[0].squaredNorm(), v[1].squaredNorm(), v[2].squaredNorm(),
          v[0].dot(v[1]),     v[0].dot(v[2]),     v[1].dot(v[2])};
}

}  // namespace mica::host::reference
