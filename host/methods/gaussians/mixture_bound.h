#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace mica::host {

/// What the bounds of a mixture know of one of its elements: mean and covariance on the disk or of slopes,
/// without roughness.
struct ElementMoments {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  double xx = 0, xy = 0, yy = 0;
};

/// Units of a node's numbers.
struct BoundUnits {
  double mean = 1, spread = 1;
};

/// Writes what one child of a node holds, MICA_MIXTURE_NODE_STRIDE shorts for sixteen of them: an axis, the
/// interval of the means along and across it, and the roots of a and c, such that diag(a, c) - covariance is
/// positive semi-definite for every element in the axis' frame. On a tilted and bent surface the image of a
/// square of texels is long and thin, and so are its elements: the axis is the longest one.
/// Rounded outwards. A child without elements gets an empty interval.
void store_bound(const std::vector<ElementMoments>& elements, const BoundUnits& units, int child,
                 std::int16_t* node);

}  // namespace mica::host
