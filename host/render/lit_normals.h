#pragma once

#include "host/base/query.h"
#include "host/surface/normal_bounds.h"

namespace mica::host {

/// Which queries normals under their footprints can answer at all. The density of any other one is less than
/// 1e-7 of its Gaussians' peak, from where on `triangles` counts it as 0 at its most exact.
class LitNormals {
 public:
  explicit LitNormals(const Surface& surface);

  /// False only where no normal within the footprint's reach is near the half vector, wherever it turns.
  bool may_answer(const Query& query) const;

 private:
  NormalBounds bounds_;
  double lobe_variance_;
  double cutoff_;
};

}  // namespace mica::host
