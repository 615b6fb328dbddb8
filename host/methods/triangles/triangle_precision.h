#pragma once

namespace mica::host {

/// The most that `triangles` are off by unless they are asked for less precision, and the most that they can
/// be asked for, relative L2.
constexpr double kExactTriangles = 1e-4, kRoughTriangles = 3e-2;

/// What a tolerance makes of `triangles`.
struct TrianglePrecision {
  int level = 0;      ///< MICA_PRECISION of kernels/triangles/precision.h
  double cutoff = 0;  ///< exponents from which culling drops: of both Gaussians together, -2 log(weight)
  double kept = 1;    ///< share of a density that it keeps, as it is on average: answers are divided by it
};

/// @param tolerance relative L2 over queries; kRoughTriangles for what is larger.
TrianglePrecision triangle_precision(double tolerance);

}  // namespace mica::host
