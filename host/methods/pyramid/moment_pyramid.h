#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "host/surface/surface.h"
#include "kernels/pyramid/pyramid_types.h"

namespace mica::host {

/// How a level lies on its map.
struct PyramidShape {
  device_types::mica_map_grid grid{};  ///< the map, and in place of blocks the level's groups
  int group_size = 0;                  ///< texels a side; the last groups may be cut
  int record_bits = 16;                ///< of a record's numbers: 16 or 8
  double spread = 0;  ///< largest square root of a variance of the bounds of positions, texels
};

/// A level of merged elements as the kernel reads it: one 4D Gaussian for each block of the map and cell of
/// the normal disk that is not empty.
struct PyramidLevel {
  PyramidShape shape;
  std::vector<std::int32_t> groups;  ///< index of each group's first top node, and of the one after the last
  std::vector<std::int16_t> top_nodes;  ///< MICA_PYRAMID_NODE_STRIDE each: bounds of sixteen nodes
  std::vector<std::int16_t> nodes;      ///< of sixteen records
  std::vector<std::int16_t> records;    ///< record_stride(record_bits) each: sixteen elements
  std::size_t elements = 0;

  std::size_t bytes() const;
};

/// Smallest block that a level may have, texels.
constexpr int kFinestBlock = 16;

/// The levels of a map for one width of the normal disk's cells: blocks of `finest_block` texels, and of
/// every power of two times that, up to the first that is the whole map.
struct PyramidLevels {
  double cell_width = 0;
  int finest_block = kFinestBlock;  ///< texels: 16 or 24 times a power of two
  bool compact =
      false;  ///< 8 bits a number in place of 16, and no light cells: a third to a half of the bytes
};

/// Whether the texels' normals lie so far apart that even on the whole map three quarters have a cell of
/// their own: then levels have more elements than the map has texels.
bool hardly_merges(const Surface& surface, double cell_width);

/// The finest levels that take at most `bytes` together, by a sample of their blocks; compact where others
/// would take more. The whole map's alone where none fit.
PyramidLevels levels_that_fit(const Surface& surface, double cell_width, std::size_t bytes);

/// Block size of the level whose single block is the whole map.
int whole_map_block(int map_width, int map_height, int finest_block);

/// Builds, in parallel, the level of `finest_block` and all coarser ones. A level's bytes do not depend on
/// which finer ones are built.
/// @param take gets the levels with their block size, finest first.
void build_moment_pyramid(const Surface& surface, const PyramidLevels& levels,
                          const std::function<void(int block, PyramidLevel level)>& take);

/// Elements of a level, from a sample of its blocks.
struct ElementCounts {
  double whole = 0, compact = 0;
};
/// Infinite where both are above `most`, which is told by as few blocks as it takes.
ElementCounts estimate_elements(const Surface& surface, double cell_width, int block,
                                double most = std::numeric_limits<double>::infinity());

}  // namespace mica::host
