#pragma once

#include <vector>

#include "host/reference/block_integrator.h"
#include "host/reference/cell_map.h"
#include "host/reference/normal_pyramid.h"
#include "host/reference/query_frame.h"
#include "host/reference/running_integral.h"

namespace mica::host::reference {

/// Integrates one query over the plane. Nodes of the pyramid, repeated with the map's period, wait in a
/// queue; the one that may matter most is opened, or integrated if it is a block, until those that wait
/// cannot matter.
class BestFirstSearch {
 public:
  BestFirstSearch(const CellMap& map, const NormalPyramid& pyramid, const TriangleRules& rules,
                  const QueryFrame& frame, RunningIntegral* integral);

  void run();

 private:
  struct Node {
    double nearest_squared;  ///< lower bound of |w|^2
    double area_texels;
    double urgency;  ///< the less the more urgent: nearest_squared, less what a large area makes up for
    int level, i, j;
    long period_x, period_y;
  };
  /// Cells in the plane, from begin to before end.
  struct CellRange {
    long begin_i, begin_j, end_i, end_j;
  };

  static bool is_later(const Node& a, const Node& b) { return a.urgency > b.urgency; }
  void push_periods();
  void push(int level, int i, int j, long period_x, long period_y);
  Node pop();
  void open(const Node& node);
  CellRange cells_of(int level, int i, int j, long period_x, long period_y) const;
  double lower_bound(const NormalBox& box, const CellRange& cells) const;

  const CellMap& map_;
  const NormalPyramid& pyramid_;
  const QueryFrame& frame_;
  RunningIntegral& integral_;
  BlockIntegrator block_integrator_;
  std::vector<Node> queue_;
};

}  // namespace mica::host::reference
