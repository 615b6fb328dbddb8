// Pearson's chi-square test of drawn directions against a density, as in pbrt-v4: bins of the sphere, those
// with few expected samples pooled, and a significance that is corrected for the number of tests.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <functional>
#include <numeric>
#include <string>
#include <vector>

namespace mica::host::statistics {

/// Significance of one of `tests` independent tests that together reject a true hypothesis with probability
/// `alpha`. Sidak 1967.
inline double sidak(double alpha, int tests) {
  return -std::expm1(std::log1p(-alpha) / tests);
}

struct ChiSquare {
  double statistic = 0;
  int degrees_of_freedom = 0;
  double p_value = 0;
};

/// Observed counts against expected ones, which add up to the same number of samples. Cells with the smallest
/// expectations are pooled until the pool expects `least` samples. A cell that expects none and has some
/// gives a p-value of 0.
inline ChiSquare chi_square(const std::vector<double>& observed, const std::vector<double>& expected,
                            double least = 5) {
  std::vector<std::size_t> order(expected.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return expected[a] < expected[b]; });
  ChiSquare result;
  int cells = 0;
  double pooled_observed = 0, pooled_expected = 0;
  const auto close = [&](double seen, double awaited) {
    result.statistic += (seen - awaited) * (seen - awaited) / awaited;
    ++cells;
  };
  for (const std::size_t cell : order) {
    pooled_observed += observed[cell], pooled_expected += expected[cell];
    if (pooled_expected < least) continue;
    close(pooled_observed, pooled_expected);
    pooled_observed = pooled_expected = 0;
  }
  if (pooled_expected > 0) close(pooled_observed, pooled_expected);
  if (pooled_expected == 0 && pooled_observed > 0) return {INFINITY, cells, 0};
  result.degrees_of_freedom = cells - 1;
  if (cells > 1)
    result.p_value = boost::math::gamma_q(0.5 * result.degrees_of_freedom, 0.5 * result.statistic);
  if (cells == 1) result.p_value = 1;
  return result;
}

/// Bins of the sphere, even in the polar angle from z and in the azimuth.
class SphereBins {
 public:
  SphereBins(int rings, int sectors) : rings_(rings), sectors_(sectors) {}

  std::size_t size() const { return static_cast<std::size_t>(rings_) * sectors_; }

  std::size_t bin(const Eigen::Vector3d& direction) const {
    const double polar = std::atan2(direction.head<2>().norm(), direction.z()) / M_PI;
    const double azimuth = std::atan2(direction.y(), direction.x()) / (2 * M_PI) + 0.5;
    const int ring = std::clamp(static_cast<int>(polar * rings_), 0, rings_ - 1);
    const int sector = std::clamp(static_cast<int>(azimuth * sectors_), 0, sectors_ - 1);
    return static_cast<std::size_t>(ring) * sectors_ + sector;
  }

  /// Integral of a density per steradian over every bin, by points x points midpoints each.
  std::vector<double> integrate(
      const std::function<std::vector<double>(const std::vector<Eigen::Vector3d>&)>& density,
      int points) const {
    std::vector<Eigen::Vector3d> directions;
    std::vector<double> areas;
    for (int y = 0; y < rings_ * points; ++y) {
      const double polar = M_PI * (y + 0.5) / (rings_ * points);
      const double ring_area = 4 * M_PI * std::sin(polar) * std::sin(0.5 * M_PI / (rings_ * points));
      for (int x = 0; x < sectors_ * points; ++x) {
        const double azimuth = 2 * M_PI * ((x + 0.5) / (sectors_ * points) - 0.5);
        directions.emplace_back(std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth),
                                std::cos(polar));
        areas.push_back(ring_area / (sectors_ * points));
      }
    }
    const std::vector<double> densities = density(directions);
    std::vector<double> integrals(size());
    for (std::size_t n = 0; n < directions.size(); ++n)
      integrals[bin(directions[n])] += densities[n] * areas[n];
    return integrals;
  }

 private:
  int rings_, sectors_;
};

/// Drawn directions against the integrals of their density over bins. What the integrals lack of one is the
/// probability that nothing is drawn. @param attempts samples, and those that drew nothing.
inline ChiSquare chi_square_of_directions(const SphereBins& bins, const std::vector<Eigen::Vector3d>& samples,
                                          std::size_t attempts, const std::vector<double>& integrals) {
  std::vector<double> observed(bins.size() + 1), expected(bins.size() + 1);
  for (const Eigen::Vector3d& sample : samples) ++observed[bins.bin(sample)];
  double total = 0;
  for (std::size_t n = 0; n < bins.size(); ++n) {
    expected[n] = integrals[n] * static_cast<double>(attempts);
    total += integrals[n];
  }
  observed.back() = static_cast<double>(attempts - samples.size());
  expected.back() = std::max(1 - total, 0.0) * static_cast<double>(attempts);
  return chi_square(observed, expected);
}

}  // namespace mica::host::statistics
