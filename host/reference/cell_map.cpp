#include "host/reference/cell_map.h"

#include <algorithm>

#include "host/surface/interpolate.h"

namespace mica::host::reference {

CellMap::CellMap(const Surface& surface)
    : surface_(surface),
      cells_a_texel_(surface.interpolation() == Interpolation::bicubic ? 4 : 1),
      columns_(surface.width() * cells_a_texel_),
      rows_(surface.height() * cells_a_texel_),
      origin_(surface.interpolation() == Interpolation::nearest ? 0.0 : 0.5) {}

CellMap::Block CellMap::block(int block_i, int block_j) const {
  const int first_i = block_i * block_cells, first_j = block_j * block_cells;
  Block block;
  block.columns = std::min(block_cells, columns_ - first_i);
  block.rows = std::min(block_cells, rows_ - first_j);
  block.shared_corners_ = surface_.interpolation() != Interpolation::nearest;
  if (surface_.interpolation() == Interpolation::bicubic) {
    fill_bicubic(first_i / cells_a_texel_, first_j / cells_a_texel_, &block);
  } else {
    fill_from_texels(first_i, first_j, &block);
  }
  return block;
}

void CellMap::fill_from_texels(int first_i, int first_j, Block* block) const {
  const bool extra = block->shared_corners_;
  for (int j = 0; j < block->rows + (extra ? 1 : 0); ++j) {
    const Eigen::Vector2d* row = &surface_.texel(0, first_j + j);
    for (int i = 0; i < block->columns; ++i) block->normals_[j * Block::pitch + i] = row[first_i + i];
    const int next = (first_i + block->columns) % surface_.width();
    if (extra) block->normals_[j * Block::pitch + block->columns] = row[next];
  }
}

void CellMap::fill_bicubic(int first_i, int first_j, Block* block) const {
  constexpr int texel_span =
      block_cells / 4 + 3;  // from one before the first quad to two after the last one's start
  std::array<Eigen::Vector4d, 4> weights;
  for (int k = 0; k < 4; ++k) weights[k] = catmull_rom_weights(k / 4.0);

  // First along u in each row of texels, then along v.
  std::array<std::array<Eigen::Vector2d, Block::pitch>, texel_span + 1> rows;
  for (int j = 0; j <= texel_span; ++j) {
    std::array<Eigen::Vector2d, texel_span + 1> texels;
    for (int i = 0; i <= texel_span; ++i) texels[i] = surface_.texel(first_i + i - 1, first_j + j - 1);
    for (int a = 0; a < Block::pitch; ++a) {
      const Eigen::Vector4d& w = weights[a % 4];
      const Eigen::Vector2d* t = &texels[a / 4];
      rows[j][a] = w[0] * t[0] + w[1] * t[1] + w[2] * t[2] + w[3] * t[3];
    }
  }
  for (int b = 0; b < Block::pitch; ++b) {
    const Eigen::Vector4d& w = weights[b % 4];
    const auto* r = &rows[b / 4];
    for (int a = 0; a < Block::pitch; ++a) {
      block->normals_[b * Block::pitch + a] =
          w[0] * r[0][a] + w[1] * r[1][a] + w[2] * r[2][a] + w[3] * r[3][a];
    }
  }
}

NormalBox CellMap::block_bounds(int block_i, int block_j) const {
  // Triangles stay within their corners, and texel squares within their texels. Actual corners are bounded,
  // bicubic ones too, so overshoot needs no allowance.
  const Block all = block(block_i, block_j);
  NormalBox box;
  for (int j = 0; j < all.rows; ++j) {
    for (int i = 0; i < all.columns; ++i) {
      for (const int corner : {0, 1, 2, 3}) box.include(all.normal(i, j, corner & 1, corner >> 1));
    }
  }
  return box;
}

}  // namespace mica::host::reference
