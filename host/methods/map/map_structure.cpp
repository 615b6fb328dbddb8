#include "host/methods/map/map_structure.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "host/methods/map/normal_box.h"

namespace mica::host {
namespace {

using namespace device_types;

constexpr int kApronBefore = 1;  // texels stored left of and below a block
constexpr int kChildren = 16;

/// Bicubic values between texels exceed them. The absolute Catmull-Rom weights sum to at most 25/16, so a
/// value differs from the middle of its sixteen control points by at most 25/16 of half their range.
NormalBox catmull_rom_bound(const NormalBox& control) {
  const auto widen = [](std::int64_t low, std::int64_t high, std::int64_t* wide_low,
                        std::int64_t* wide_high) {
    const std::int64_t extra = (high - low) * 9 / 32 + 1;
    *wide_low = low - extra, *wide_high = high + extra;
  };
  NormalBox box;
  widen(control.s_min, control.s_max, &box.s_min, &box.s_max);
  widen(control.t_min, control.t_max, &box.t_min, &box.t_max);
  return box;
}

/// One block: its normals with their apron, then bounds from the quads up.
class BlockBuilder {
 public:
  BlockBuilder(const Surface& surface, int block_x, int block_y, std::int32_t* normals)
      : interpolation_(surface.interpolation()),
        room_i_(std::min<int>(MICA_BLOCK, surface.width() - block_x * MICA_BLOCK)),
        room_j_(std::min<int>(MICA_BLOCK, surface.height() - block_y * MICA_BLOCK)),
        normals_(normals) {
    for (int row = 0; row < MICA_BLOCK_ROW; ++row) {
      for (int column = 0; column < MICA_BLOCK_ROW; ++column) {
        const Eigen::Vector2d& n = surface.texel(block_x * MICA_BLOCK + column - kApronBefore,
                                                 block_y * MICA_BLOCK + row - kApronBefore);
        const int at = row * MICA_BLOCK_ROW + column;
        normals_[at] = static_cast<std::int32_t>(std::lround(n.x() * MICA_NORMAL_ONE));
        normals_[at + MICA_BLOCK_PLANE] = static_cast<std::int32_t>(std::lround(n.y() * MICA_NORMAL_ONE));
      }
    }
  }

  void bound(std::int16_t* block_node, std::int16_t* tile_nodes) const {
    for (int tile = 0; tile < kChildren; ++tile) {
      NormalBox tile_box;
      for (int leaf = 0; leaf < kChildren; ++leaf) {
        const NormalBox leaf_box = bound_leaf((tile & 3) * MICA_TILE + (leaf & 3) * MICA_LEAF,
                                              (tile >> 2) * MICA_TILE + (leaf >> 2) * MICA_LEAF);
        store(leaf_box, leaf, tile_nodes + tile * MICA_NODE_STRIDE);
        tile_box.add(leaf_box);
      }
      store(tile_box, tile, block_node);
    }
  }

 private:
  NormalBox bound_leaf(int first_i, int first_j) const {
    NormalBox box;
    for (int j = first_j; j < std::min(first_j + MICA_LEAF, room_j_); ++j)
      for (int i = first_i; i < std::min(first_i + MICA_LEAF, room_i_); ++i) box.add(bound_quad(i, j));
    return box;
  }

  NormalBox bound_quad(int i, int j) const {
    switch (interpolation_) {
      case Interpolation::nearest:
        return texels(i, j, 0, 0);
      case Interpolation::bilinear:
        return texels(i, j, 0, 1);
      case Interpolation::bicubic:
        return catmull_rom_bound(texels(i, j, -1, 2));
    }
    return {};
  }

  NormalBox texels(int i, int j, int from, int to) const {
    NormalBox box;
    for (int y = j + from; y <= j + to; ++y) {
      for (int x = i + from; x <= i + to; ++x) {
        const int at = (y + kApronBefore) * MICA_BLOCK_ROW + x + kApronBefore;
        box.add(normals_[at], normals_[at + MICA_BLOCK_PLANE]);
      }
    }
    return box;
  }

  Interpolation interpolation_;
  int room_i_, room_j_;  // texels of the map in this block
  std::int32_t* normals_;
};

int blocks(int texels) {
  return (texels + MICA_BLOCK - 1) / MICA_BLOCK;
}

}  // namespace

std::size_t MapStructure::bytes() const {
  return normals.size() * sizeof(normals[0]) +
         (block_nodes.size() + tile_nodes.size()) * sizeof(block_nodes[0]);
}

std::size_t map_structure_bytes(int width, int height) {
  const std::size_t count = static_cast<std::size_t>(blocks(width)) * blocks(height);
  const std::size_t normals = count * MICA_BLOCK_STRIDE + MICA_NORMALS_PADDING;
  const std::size_t bounds = count * (1 + kChildren) * MICA_NODE_STRIDE;
  return normals * sizeof(std::int32_t) + bounds * sizeof(std::int16_t);
}

MapStructure build_map_structure(const Surface& surface) {
  MapStructure map;
  map.grid = {surface.width(), surface.height(), blocks(surface.width()), blocks(surface.height())};
  const std::size_t count = static_cast<std::size_t>(map.grid.blocks_x) * map.grid.blocks_y;
  map.normals.resize(count * MICA_BLOCK_STRIDE + MICA_NORMALS_PADDING);
  map.block_nodes.resize(count * MICA_NODE_STRIDE);
  map.tile_nodes.resize(count * kChildren * MICA_NODE_STRIDE);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t block) {
    const BlockBuilder builder(surface, static_cast<int>(block % map.grid.blocks_x),
                               static_cast<int>(block / map.grid.blocks_x),
                               map.normals.data() + block * MICA_BLOCK_STRIDE);
    builder.bound(map.block_nodes.data() + block * MICA_NODE_STRIDE,
                  map.tile_nodes.data() + block * kChildren * MICA_NODE_STRIDE);
  });
  return map;
}

}  // namespace mica::host
