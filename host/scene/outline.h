#pragma once

#include <Eigen/Core>
#include <vector>

#include "host/scene/mesh.h"

namespace mica::host {

/// A point of an outline in the half plane (distance from the axis, height), and the outline's unit normal
/// there.
struct OutlinePoint {
  Eigen::Vector2d position, normal;
};

/// A corner of an outline, and the radius of the arc that replaces it.
struct OutlineCorner {
  Eigen::Vector2d position;
  double radius;
};

/// An outline through corners, each rounded by an arc that touches both its sides; the normal is to the right
/// of the direction in which it runs.
/// @param corners at least two; the first and the last are its ends, whose radius is of no effect.
std::vector<OutlinePoint> rounded_outline(const std::vector<OutlineCorner>& corners);

/// Adds the surface that `outline` sweeps around the z axis, as a part of its own. u runs around, from the +y
/// side to the left seen from above; v along the outline, in units of `circumference`.
void add_revolved(const std::vector<OutlinePoint>& outline, double circumference, const std::string& part,
                  TriangleMesh* mesh);

}  // namespace mica::host
