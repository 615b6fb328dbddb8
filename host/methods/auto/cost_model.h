#pragma once

#include "host/base/query.h"
#include "host/surface/description.h"

namespace mica::host {

/// Nanoseconds of one core, of a query, of one block of the map that its footprint reaches, and of one thing
/// that is counted of it; and of building the structure, of a texel of the map, or of a piece of one that a
/// pyramid merges. Measured on one machine, with waves of AVX2 and triangles to 1%: only their ratios matter.
/// `auto_bench` fits them, of queries without a first order and with one.
struct CostModel {
  double query, block, count, texel;

  double of(double blocks, double counted) const { return query + block * blocks + count * counted; }
};

/// What one block is to the walks of kernels/map/walk_leaves.h: how many the square around a footprint
/// touches.
double blocks_reached(const Query& query, int map_width, int map_height);

/// Of `gaussians` with so many elements a texel and axis, 1, 2 or 4. What is counted are the elements of
/// kCountedMixture: its structure is the smallest, and tells as much.
CostModel gaussians_cost(int elements, bool first_order);
constexpr int kCountedMixture = 1;

/// By the floating-point operations.
CostModel triangles_cost(Interpolation interpolation, bool first_order);

/// By the elements.
CostModel pyramid_cost(bool first_order);

}  // namespace mica::host
