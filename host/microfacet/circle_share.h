#pragma once

#include <Eigen/Core>

namespace mica::host {

/// Probability that a Gaussian about `center` with standard deviations `sigma` along x and y stays in the
/// unit circle, to 1e-6 for a centre in it.
double share_in_unit_circle(const Eigen::Vector2d& center, const Eigen::Vector2d& sigma);

}  // namespace mica::host
