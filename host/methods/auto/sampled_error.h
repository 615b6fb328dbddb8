#pragma once

#include <vector>

namespace mica::host {

/// The relative L2, sqrt(sum (D - ref)^2 / sum ref^2), of many queries, as a random sample of them tells it.
struct SampledError {
  double relative_l2 = 0;                   ///< of the sample
  double deviation = 0;                     ///< its standard deviation
  double lower_bound = 0, upper_bound = 0;  ///< of that of all queries, each at the confidence asked for
};

/// @param quantile of the standard normal distribution: how confident one can be of a bound.
/// @param expected as many as `densities`, two at least. Where all are 0 the error is infinite.
SampledError sampled_error(const std::vector<float>& densities, const std::vector<float>& expected,
                           double quantile);

/// Of densities: 0 of none.
double mean_square(const std::vector<float>& densities);

/// Sum of their squares over their sum; 0 where all are dark.
double typical_density(const std::vector<float>& densities);

/// What makes of estimates sqrt(D max(D, T)) of densities such that have the bound on their sum of squares.
double share_of_bound(const std::vector<float>& densities, double typical);

}  // namespace mica::host
