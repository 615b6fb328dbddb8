#pragma once

#include <Eigen/Core>

namespace mica::host {

/// Variance, periods^2, of a footprint that sees all of the map alike, as far as floats can tell.
constexpr double kUniformVariance = 0.8 * 0.8;

/// The least and largest standard deviation of a lobe on the disk.
constexpr double kMinRoughness = 1e-5, kMaxRoughness = 1;

/// Two integer vectors that span all others, such that `form` of the first is the least of all and that of
/// the second the least of those it does not divide: Lagrange's reduction.
Eigen::Matrix2d reduced_waves(const Eigen::Matrix2d& form);

}  // namespace mica::host
