#pragma once

#include "host/reference/cell_map.h"
#include "host/reference/query_frame.h"
#include "host/reference/running_integral.h"
#include "host/reference/triangle_batch.h"

namespace mica::host::reference {

/// Adds the integral over blocks of cells to that of one query. Keeps references to its arguments.
class BlockIntegrator {
 public:
  BlockIntegrator(const CellMap& map, const TriangleRules& rules, const QueryFrame& frame,
                  RunningIntegral* integral)
      : map_(map), rules_(rules), frame_(frame), integral_(*integral) {}

  /// @param block_i, block_j a block of the map
  /// @param period_x, period_y which of its repetitions in the plane
  void integrate(int block_i, int block_j, long period_x, long period_y);

 private:
  void collect_cells(int block_i, int block_j, long period_x, long period_y);
  void collect_triangles();
  void promise_something();

  const CellMap& map_;
  const TriangleRules& rules_;
  const QueryFrame& frame_;
  RunningIntegral& integral_;
  CellBatch cells_;
  TriangleBatch triangles_;
};

}  // namespace mica::host::reference
