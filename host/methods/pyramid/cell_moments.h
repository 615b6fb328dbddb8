#pragma once

#include <utility>
#include <vector>

#include "host/methods/pyramid/moments.h"
#include "host/surface/surface.h"

namespace mica::host {

/// Square cells over the normals of a map.
class NormalCells {
 public:
  NormalCells(const Surface& surface, double width);

  double width() const { return width_; }
  int columns() const { return columns_; }
  int count() const { return columns_ * rows_; }
  int cell_of(double s, double t) const;

 private:
  double width_, low_s_, low_t_;
  int columns_, rows_;
};

/// Moments of square blocks of the map by cell of the normal. A block's are summed in a fixed order,
/// whichever blocks are asked for: from its four quarters, down to squares of `kBaseBlock` texels or half as
/// many more, triangle by triangle.
class BlockMoments {
 public:
  static constexpr int kBaseBlock = 16;  ///< texels a side

  /// Both have to outlive this.
  BlockMoments(const Surface& surface, const NormalCells& cells);

  /// The block whose lower left texel is (first_i, first_j); cut at the map's edge. By cell, in their order.
  /// @param size kBaseBlock, or 3 / 2 of it, times a power of two.
  std::vector<CellMoments> block(int first_i, int first_j, int size);

  /// The same of a block whose quarters are known.
  std::vector<CellMoments> merge(const std::vector<const std::vector<CellMoments>*>& quarters);

 private:
  std::vector<CellMoments> base_block(int first_i, int first_j, int size);
  void add_texel(long i, long j);
  void add_triangle(const Eigen::Vector4d& a, const Eigen::Vector4d& b, const Eigen::Vector4d& c);
  /// One of its pieces, with one normal for all of it.
  void add_piece(const Eigen::Vector4d& a, const Eigen::Vector4d& b, const Eigen::Vector4d& c);
  /// A triangle in strips along the side from b to c, and these in up to so many cuts.
  void add_strips(const Eigen::Vector4d& apex, const Eigen::Vector4d& b, const Eigen::Vector4d& c, int strips,
                  int cuts);
  void add_square(const Eigen::Vector2d& corner, const Eigen::Vector2d& normal);
  Moments& at(int cell);
  std::vector<CellMoments> take();

  const Surface& surface_;
  const NormalCells& cells_;
  std::vector<int> place_of_cell_;          // in sums_, or -1
  std::vector<CellMoments> sums_;           // in the order in which cells were first met
  std::vector<std::pair<int, int>> order_;  // of cells, with their places in sums_
};

/// A block's moments, by cell, with those of hardly any weight added to the neighbouring cell whose normal is
/// nearest: many cells hold only a texel's corner. Sums of moments stay what they are.
std::vector<CellMoments> without_light_cells(const NormalCells& cells, std::vector<CellMoments> parts);

}  // namespace mica::host
