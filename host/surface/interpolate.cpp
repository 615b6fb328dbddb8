#include "host/surface/interpolate.h"

#include <cmath>

namespace mica::host {
namespace {

/// Linear interpolation on the lattice of `vertex(a, b)` at integer positions, each cell split from (a+1, b)
/// to (a, b+1).
template <typename VertexFunction>
Eigen::Vector2d piecewise_linear(const Eigen::Vector2d& position, const VertexFunction& vertex) {
  const Eigen::Vector2d corner(std::floor(position.x()), std::floor(position.y()));
  const long a = static_cast<long>(corner.x()), b = static_cast<long>(corner.y());
  const Eigen::Vector2d f = position - corner;
  const Eigen::Vector2d right = vertex(a + 1, b), top = vertex(a, b + 1);
  if (f.x() + f.y() <= 1) {
    const Eigen::Vector2d origin = vertex(a, b);
    return origin + f.x() * (right - origin) + f.y() * (top - origin);
  }
  const Eigen::Vector2d opposite = vertex(a + 1, b + 1);
  return opposite + (1 - f.x()) * (top - opposite) + (1 - f.y()) * (right - opposite);
}

}  // namespace

Eigen::Vector4d catmull_rom_weights(double f) {
  return 0.5 * Eigen::Vector4d(f * (-1 + f * (2 - f)), 2 + f * f * (-5 + 3 * f), f * (1 + f * (4 - 3 * f)),
                               f * f * (f - 1));
}

Eigen::Vector2d bicubic_vertex(const Surface& surface, long a, long b) {
  const long i = (a - (a & 3)) / 4, j = (b - (b & 3)) / 4;  // rounds down, for negative numbers too
  if ((a & 3) == 0 && (b & 3) == 0) return surface.texel(i, j);
  const Eigen::Vector4d weights_u = catmull_rom_weights(0.25 * static_cast<double>(a & 3));
  const Eigen::Vector4d weights_v = catmull_rom_weights(0.25 * static_cast<double>(b & 3));
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      sum += weights_u[column] * weights_v[row] * surface.texel(i + column - 1, j + row - 1);
    }
  }
  return sum;
}

Eigen::Vector2d normal_at(const Surface& surface, const Eigen::Vector2d& position_texels) {
  const Eigen::Vector2d from_center = position_texels - Eigen::Vector2d(0.5, 0.5);
  switch (surface.interpolation()) {
    case Interpolation::nearest:
      return surface.texel(static_cast<long>(std::floor(position_texels.x())),
                           static_cast<long>(std::floor(position_texels.y())));
    case Interpolation::bilinear:
      return piecewise_linear(from_center, [&](long i, long j) { return surface.texel(i, j); });
    case Interpolation::bicubic:
      break;
  }
  return piecewise_linear(4 * from_center, [&](long a, long b) { return bicubic_vertex(surface, a, b); });
}

}  // namespace mica::host
