#include "host/methods/auto/sampled_error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace mica::host {

/// The squared error is a ratio of two means, whose deviation and skewness those of its linearisation are.
/// Few queries may make most of the error, and a sample that misses them thinks itself precise: what is taken
/// for nearly normal is therefore the ratio's logarithm, and its quantile is Student's, corrected for
/// skewness [Johnson 1978, Modified t tests and confidence intervals for asymmetrical populations].
SampledError sampled_error(const std::vector<float>& densities, const std::vector<float>& expected,
                           double quantile) {
  const std::size_t size = expected.size();
  const auto count = static_cast<double>(size);
  std::vector<double> squares(size), references(size);
  for (std::size_t n = 0; n < size; ++n) {
    const double reference = expected[n], difference = densities[n] - reference;
    squares[n] = difference * difference, references[n] = reference * reference;
  }
  const double square = std::accumulate(squares.begin(), squares.end(), 0.0) / count,
               reference = std::accumulate(references.begin(), references.end(), 0.0) / count;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  if (!(reference > 0)) return {infinity, infinity, 0, infinity};
  if (square == 0) return {};
  const double ratio = square / reference;
  double second_moment = 0, third_moment = 0;
  for (std::size_t n = 0; n < size; ++n) {
    const double influence = squares[n] / square - references[n] / reference;  // on the ratio's logarithm
    second_moment += influence * influence / count;
    third_moment += influence * influence * influence / count;
  }
  const double deviation = std::sqrt(second_moment / (count - 1)),
               skewness = second_moment > 0 ? std::max(third_moment / std::pow(second_moment, 1.5), 0.0) : 0,
               students = quantile + (std::pow(quantile, 3) + quantile) / (4 * (count - 1)),
               correction = skewness * (1 + 2 * quantile * quantile) / (6 * std::sqrt(count));
  const double error = std::sqrt(ratio);
  return {error, 0.5 * error * deviation, error * std::exp(-0.5 * deviation * students),
          error * std::exp(0.5 * deviation * (students + correction))};
}

double mean_square(const std::vector<float>& densities) {
  double squares = 0;
  for (const double density : densities) squares += density * density;
  return densities.empty() ? 0 : squares / static_cast<double>(densities.size());
}

double typical_density(const std::vector<float>& densities) {
  double squares = 0, sum = 0;
  for (const double density : densities) squares += density * density, sum += density;
  return sum > 0 ? squares / sum : 0;
}

double share_of_bound(const std::vector<float>& densities, double typical) {
  double squares = 0, estimates = 0;
  for (const double density : densities)
    squares += density * density, estimates += density * std::max(density, typical);
  return estimates > 0 ? std::sqrt(squares / estimates) : 1;
}

}  // namespace mica::host
