#pragma once

#include <vector>

#include "host/scene/viewer.h"

namespace mica::host {

/// Sums of one pixel's AOVs over the samples that hit a shape.
class PixelMeans {
 public:
  void add(const Footprint& footprint, const Eigen::Vector3d& normal);
  void write(TracedRows* rows, std::size_t pixel) const;

 private:
  int count_ = 0;
  Eigen::Vector2d first_uv_{0, 0}, uv_offset_{0, 0};
  Eigen::Vector3d covariance_{0, 0, 0}, normal_{0, 0, 0};
};

/// Rows of which nothing is known yet.
TracedRows empty_rows(int first_row, int row_count, int width);

/// Moves the queries of all rows, in their order, into `all`.
void join_queries(std::vector<RowQueries>* rows, TracedRows* all);

}  // namespace mica::host
