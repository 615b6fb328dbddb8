#pragma once

#include <vector>

#include "host/reference/cell_map.h"

namespace mica::host::reference {

/// Bounds of the normals over one period of a cell map, block by block, then over 2x2 nodes of the level
/// below, up to a single node.
class NormalPyramid {
 public:
  explicit NormalPyramid(const CellMap& map);

  int top_level() const { return static_cast<int>(levels_.size()) - 1; }
  int columns(int level) const { return levels_[level].columns; }
  int rows(int level) const { return levels_[level].rows; }
  const NormalBox& bounds(int level, int i, int j) const {
    return levels_[level].boxes[static_cast<std::size_t>(j) * levels_[level].columns + i];
  }

 private:
  struct Level {
    int columns, rows;
    std::vector<NormalBox> boxes;
  };
  std::vector<Level> levels_;  ///< level 0: one node a block
};

}  // namespace mica::host::reference
