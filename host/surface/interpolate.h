#pragma once

#include <Eigen/Core>

#include "host/surface/surface.h"

namespace mica::host {

/// Catmull-Rom weights of the four samples at -1, 0, 1, 2 for a position `f` in [0, 1] between the middle
/// two. They add up to 1; at f = 0 and 1 they select one sample exactly.
Eigen::Vector4d catmull_rom_weights(double f);

/// Vertex (a, b) of the quarter-texel lattice that `bicubic` is made of: Catmull-Rom at (a / 4 + 0.5, b / 4 +
/// 0.5) texels. Where a and b are multiples of 4 this is texel (a / 4, b / 4) itself. Any integers, wrapped.
/// Catmull-Rom overshoots: next to a steep step the result may lie slightly outside the range of its texels,
/// even outside the unit disk.
Eigen::Vector2d bicubic_vertex(const Surface& surface, long a, long b);

/// The normal (s, t) on the unit disk at a position in texels, periodic: the triangulated surface of [Yan14]
/// sec. 5 that every evaluator integrates, without any further approximation.
///  - `nearest`: the texel whose square holds the position;
///  - `bilinear`: linear on two triangles a quad of texel centres, split from (i+1, j) to (i, j+1);
///  - `bicubic`: linear on two triangles, split alike, of each of the 4x4 parts of a quad, whose corners are
///    bicubic_vertex().
/// @param position_texels (i + 0.5, j + 0.5) is the centre of texel (i, j); finite, below 2^50 in magnitude.
/// Wrap
///   large coordinates first to keep their fraction.
Eigen::Vector2d normal_at(const Surface& surface, const Eigen::Vector2d& position_texels);

}  // namespace mica::host
