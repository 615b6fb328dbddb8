#pragma once

#include <Eigen/Core>
#include <array>

#include "host/surface/surface.h"

namespace mica::host::reference {

/// Bounds of normals on the disk.
struct NormalBox {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(1e300);
  Eigen::Vector2d high = Eigen::Vector2d::Constant(-1e300);

  void include(const Eigen::Vector2d& normal) {
    low = low.cwiseMin(normal);
    high = high.cwiseMax(normal);
  }
  void include(const NormalBox& box) {
    low = low.cwiseMin(box.low);
    high = high.cwiseMax(box.high);
  }
};

/// The triangulated surface of [Yan14] sec. 5 as a periodic array of square cells, each two triangles: a quad
/// of texel centres (`bilinear`), a 4x4th of one (`bicubic`), or a texel with the same normal at its four
/// corners (`nearest`). Cells are handed out in blocks. Keeps a reference to the surface.
class CellMap {
 public:
  static constexpr int block_cells =
      8;  ///< cells a side of a block; the last ones of a row or column may be cut

  /// A block's normals.
  class Block {
   public:
    int columns = 0, rows = 0;  ///< cells
    /// Normal at corner (di, dj), each 0 or 1, of the block's cell (i, j).
    const Eigen::Vector2d& normal(int i, int j, int di, int dj) const {
      return shared_corners_ ? normals_[(j + dj) * pitch + i + di] : normals_[j * pitch + i];
    }

   private:
    friend class CellMap;
    static constexpr int pitch = block_cells + 1;
    bool shared_corners_ = true;
    std::array<Eigen::Vector2d, pitch * pitch> normals_;
  };

  explicit CellMap(const Surface& surface);

  int columns() const { return columns_; }  ///< cells in a period
  int rows() const { return rows_; }
  int block_columns() const { return (columns_ + block_cells - 1) / block_cells; }
  int block_rows() const { return (rows_ + block_cells - 1) / block_cells; }

  /// Side of a cell, in texels.
  double cell_texels() const { return 1.0 / cells_a_texel_; }
  /// Lower left corner of cell (i, j) in texels.
  Eigen::Vector2d corner_texels(long i, long j) const {
    return {origin_ + static_cast<double>(i) / cells_a_texel_,
            origin_ + static_cast<double>(j) / cells_a_texel_};
  }

  Block block(int block_i, int block_j) const;
  /// Contains all normals of a block, on its triangles too.
  NormalBox block_bounds(int block_i, int block_j) const;

 private:
  void fill_from_texels(int first_i, int first_j, Block* block) const;
  void fill_bicubic(int first_i, int first_j, Block* block) const;

  const Surface& surface_;
  int cells_a_texel_, columns_, rows_;
  double origin_;
};

}  // namespace mica::host::reference
