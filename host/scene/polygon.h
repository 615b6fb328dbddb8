#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

namespace mica::host {

/// Newell's: twice the area of a closed polygon, along its normal.
Eigen::Vector3d polygon_area(const std::vector<Eigen::Vector3d>& corners);

/// Corners of triangles that cover a polygon: flat or not, convex or not, with corners along its edges, or
/// with a hole that a bridge joins to its rim. A convex one is a fan around its first corner. Those without
/// area are left out. Empty when it has no area, crosses itself, or has more than 4096 corners and is not
/// convex.
std::vector<std::array<std::size_t, 3>> triangulate(const std::vector<Eigen::Vector3d>& corners);

}  // namespace mica::host
