#pragma once

#include <Eigen/Core>

namespace mica::host::synthesis {

/// Texels from `first` to `last`, which may lie outside the period; none when last < first.
struct TexelRange {
  long first, last;
};

/// What a feature covers: a rectangle, by offsets from the feature's centre in texels.
struct Extent {
  Eigen::Vector2d axis;            ///< unit
  double half_length;              ///< along the axis
  double across_low, across_high;  ///< to the left of the axis

  /// Rows whose centres it may cover, when its centre is at height `center_v`.
  TexelRange rows(double center_v) const;
  /// Columns whose centres it may cover in the row `offset_v` above its centre at `center_u`.
  TexelRange columns(double center_u, double offset_v) const;
};

}  // namespace mica::host::synthesis
