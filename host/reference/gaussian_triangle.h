#pragma once

#include <array>

#include "host/reference/query_frame.h"
#include "host/reference/running_integral.h"
#include "host/reference/triangle_batch.h"

namespace mica::host::reference {

/// The Gaussian exp(-|w|^2 / 2) restricted to the plane of a triangle in R^4: a triangle in that plane, whose
/// origin is the plane's point nearest to w = 0, and the squared distance of the plane itself.
struct PlanarTriangle {
  std::array<Eigen::Vector2d, 3> vertices;  ///< counter-clockwise; the longest edge is 0 to 1, along +x
  std::array<int, 3> order;                 ///< vertex k was vertex order[k] in R^4
  double offset_squared = 0;

  double area() const;
  double diameter() const { return vertices[1].x() - vertices[0].x(); }
  /// Smallest |w|^2 on the triangle.
  double nearest_squared() const;
};
PlanarTriangle flatten(const std::array<Whitened, 3>& vertices);

/// Integral of exp(-|y|^2 / 2) / (2 pi) over a triangle in the plane, to 1e-15 + 4e-16 max|y| absolute, by
/// Owen's T of its edges [Owen 1956].
double normal_probability(const std::array<Eigen::Vector2d, 3>& triangle);

/// Smallest squared distance from the origin to a convex polygon, vertices counter-clockwise or clockwise.
double nearest_squared(const Eigen::Vector2d* vertices, int count);

/// Adds the integral over a triangle of `area` texels^2 to the running one: by quadrature if the Gaussian is
/// wide or far enough for a rule, else exactly if rounding leaves enough digits, else by halves.
void integrate_triangle(const std::array<Whitened, 3>& vertices, double area, const TriangleRules& rules,
                        RunningIntegral* integral);

}  // namespace mica::host::reference
