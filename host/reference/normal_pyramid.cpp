#include "host/reference/normal_pyramid.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace mica::host::reference {

NormalPyramid::NormalPyramid(const CellMap& map) {
  const int columns = map.block_columns(), rows = map.block_rows();
  levels_.push_back({columns, rows, std::vector<NormalBox>(static_cast<std::size_t>(columns) * rows)});
  tbb::parallel_for(0, rows, [&](int j) {
    for (int i = 0; i < columns; ++i) {
      levels_[0].boxes[static_cast<std::size_t>(j) * columns + i] = map.block_bounds(i, j);
    }
  });
  while (levels_.back().boxes.size() > 1) {
    const Level& below = levels_.back();
    Level level{(below.columns + 1) / 2, (below.rows + 1) / 2, {}};
    level.boxes.resize(static_cast<std::size_t>(level.columns) * level.rows);
    for (int j = 0; j < below.rows; ++j) {
      for (int i = 0; i < below.columns; ++i) {
        level.boxes[static_cast<std::size_t>(j / 2) * level.columns + i / 2].include(
            below.boxes[static_cast<std::size_t>(j) * below.columns + i]);
      }
    }
    levels_.push_back(std::move(level));
  }
}

}  // namespace mica::host::reference
