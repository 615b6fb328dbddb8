#pragma once

#include <vector>

#include "host/base/query.h"
#include "host/surface/surface.h"

namespace mica::host::bench {

/// The algorithm of [Yan14] sec. 5 and 6 as a careful C++ programmer would write it today: what `triangles`
/// is measured against. A quadtree of bounds on (s, t) down to the texel, recursion from the level of the
/// footprint's size, pruning of texels beyond 5 standard deviations of either Gaussian, two triangles a
/// texel, and Eq. 9-12 with erf as six quadratics, which are good to about 1%.
///
/// `bilinear` surfaces only; throws UsageError for others. Covariances whose 5 sigma span many periods are
/// slow.
class PaperRecursion {
 public:
  explicit PaperRecursion(const Surface& surface);

  /// D of each query; parallel over queries.
  std::vector<float> evaluate(const std::vector<Query>& queries) const;

  struct Normal {
    float s, t;
  };
  /// Bounds of the normals of a node.
  struct Box {
    Normal low{1e30f, 1e30f}, high{-1e30f, -1e30f};
  };

 private:
  friend class Traversal;

  int width_, height_;
  std::vector<Normal> normals_;  ///< row by row, one column and row more than the map: no wrapping inside
  std::vector<std::vector<Box>>
      levels_;  ///< level 0: a texel's quad; in Morton order, so siblings share a cache line
};

}  // namespace mica::host::bench
