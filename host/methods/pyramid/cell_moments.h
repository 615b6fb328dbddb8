#pragma once

#include <cstdint>
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

  static constexpr bool kTakesCovariance = true;
  /// A piece of the surface; see TexelPieces.
  void operator()(double weight, const Eigen::Vector4d& mean, const Eigen::Matrix4d& weighted_covariance) {
    at(cells_.cell_of(mean[2], mean[3])).add_weighted(weight, mean, weighted_covariance);
  }

 private:
  std::vector<CellMoments> base_block(int first_i, int first_j, int size);
  Moments& at(int cell);
  std::vector<CellMoments> take();

  const Surface& surface_;
  const NormalCells& cells_;
  std::vector<int> place_of_cell_;          // in sums_, or -1
  std::vector<CellMoments> sums_;           // in the order in which cells were first met
  std::vector<std::pair<int, int>> order_;  // of cells, with their places in sums_
};

/// Cells of a block, counted without their second moments.
struct CellCount {
  std::int64_t whole = 0;    ///< that are not empty
  std::int64_t compact = 0;  ///< those that `without_light_cells` leaves
};

/// Counts the cells of blocks, in a fraction of the time and memory that their moments take.
class CellCounter {
 public:
  /// Both have to outlive this.
  CellCounter(const Surface& surface, const NormalCells& cells);

  /// Of the block whose lower left texel is (first_i, first_j); cut at the map's edge.
  CellCount count(int first_i, int first_j, int size);

  static constexpr bool kTakesCovariance = false;
  /// A piece of the surface; see TexelPieces.
  void operator()(double weight, const Eigen::Vector4d& mean, const Eigen::Matrix4d& /*none*/) {
    Sum& sum = sums_[cells_.cell_of(mean[2], mean[3])];
    if (sum.weight < 0) {
      sum.weight = 0;
      touched_.push_back(static_cast<int>(&sum - sums_.data()));
    }
    sum.weight += weight;
    sum.normal += weight * mean.tail<2>();
  }

 private:
  struct Sum {
    double weight = -1;  // negative: empty
    Eigen::Vector2d normal{0, 0};
  };

  const Surface& surface_;
  const NormalCells& cells_;
  std::vector<Sum> sums_;  // by cell
  std::vector<int> touched_;
};

/// A block's moments, by cell, with those of hardly any weight added to the neighbouring cell whose normal is
/// nearest: many cells hold only a texel's corner. Sums of moments stay what they are.
std::vector<CellMoments> without_light_cells(const NormalCells& cells, std::vector<CellMoments> parts);

}  // namespace mica::host
