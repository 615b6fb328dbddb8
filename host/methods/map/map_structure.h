#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/surface/surface.h"
#include "kernels/types.h"

namespace mica::host {

/// A normal map as the kernels read it: fixed-point normals in blocks, and the two levels of their min-max
/// hierarchy over (s, t). [Yan14] sec. 6, on the implicit grid: neither pointers nor positions are stored.
struct MapStructure {
  device_types::mica_map_grid grid{};
  std::vector<std::int32_t> normals;      ///< MICA_BLOCK_STRIDE a block
  std::vector<std::int16_t> block_nodes;  ///< MICA_NODE_STRIDE a block: bounds of its sixteen tiles
  std::vector<std::int16_t> tile_nodes;   ///< MICA_NODE_STRIDE a tile: bounds of its sixteen leaves

  std::size_t bytes() const;
};

/// Bytes that `build_map_structure` would take for a map of this size.
std::size_t map_structure_bytes(int width, int height);

/// Builds in parallel; the bounds are those of the surface as it is interpolated, rounded outwards.
MapStructure build_map_structure(const Surface& surface);

}  // namespace mica::host
