#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "host/surface/surface.h"
#include "kernels/pyramid_types.h"

namespace mica {

/// How a level lies on its map.
struct PyramidShape {
  device_types::mica_map_grid grid{};  ///< the map, and in place of blocks the level's groups
  int group_size = 0;                  ///< texels a side; the last groups may be cut
  double spread = 0;  ///< largest square root of a variance of the bounds of positions, texels
};

/// A level of merged elements as the kernel reads it: one 4D Gaussian for each block of the map and cell of
/// the normal disk that is not empty, in 16 bits a number.
struct PyramidLevel {
  PyramidShape shape;
  std::vector<std::int32_t> groups;  ///< index of each group's first top node, and of the one after the last
  std::vector<std::int16_t> top_nodes;  ///< MICA_PYRAMID_NODE_STRIDE each: bounds of sixteen nodes
  std::vector<std::int16_t> nodes;      ///< of sixteen records
  std::vector<std::int16_t> records;    ///< MICA_RECORD_STRIDE each: sixteen elements
  std::size_t elements = 0;

  std::size_t bytes() const;
};

/// Smallest block that a level may have, texels.
constexpr int kFinestBlock = 16;

/// Builds, in parallel, the level of `finest_block` and those of every larger power of two, up to the one
/// whose single block is the whole map. A level's bytes do not depend on which others are built.
/// @param cell_width of the normal disk's cells.
/// @param finest_block texels, kFinestBlock times a power of two.
/// @param take gets the levels with their block size, finest first.
void build_moment_pyramid(const Surface& surface, double cell_width, int finest_block,
                          const std::function<void(int block, PyramidLevel level)>& take);

/// Block size of the level whose single block is the whole map.
int whole_map_block(int map_width, int map_height);

/// Bytes that a level would take, from a sample of its blocks.
std::size_t estimate_level_bytes(const Surface& surface, double cell_width, int block);

}  // namespace mica
