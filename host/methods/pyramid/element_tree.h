#pragma once

#include <cstdint>
#include <vector>

#include "host/methods/pyramid/moments.h"
#include "kernels/pyramid/pyramid_types.h"

namespace mica::host {

/// The tree over one group's elements, in the kernel's form, with children counted from the group's own
/// first.
struct ElementTree {
  std::vector<std::int16_t> top_nodes, nodes, records;
  std::size_t elements = 0;
  double largest_variance = 0;  ///< of the bounds of positions along any axis, texels^2
};

/// What sorts elements into records that are compact in position and normal, and how these are written.
struct GroupShape {
  Eigen::Vector2d corner_texels;
  double size_texels = 0, block_texels = 0, cell_width = 0;
  int record_bits = 16;
};

/// Shorts of a record whose numbers have 16 or 8 bits.
int record_stride(int record_bits);

/// @param parts of all the group's blocks.
ElementTree build_element_tree(const GroupShape& group, const std::vector<CellMoments>& parts);

}  // namespace mica::host
