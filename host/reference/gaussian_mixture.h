#pragma once

#include <vector>

#include "host/base/query.h"
#include "host/surface/surface.h"

namespace mica::host::reference {

/// The P-NDF of [Yan16]'s mixture in double precision: the plain sum over every element under the footprint,
/// weights divided by their sum. Elements lie at the centres of `elements` x `elements` squares a quad of
/// texel centres
/// (`bilinear`: mean and Jacobian of the bilinear patch there) or a texel (`nearest`: no Jacobian).
/// Thread-safe; keeps a reference to the surface.
class GaussianMixture {
 public:
  GaussianMixture(const Surface& surface, int elements) : surface_(surface), elements_(elements) {}

  double evaluate(const Query& query) const;
  std::vector<double> evaluate(const std::vector<Query>& queries) const;  ///< in parallel, in order

 private:
  const Surface& surface_;
  int elements_;
};

}  // namespace mica::host::reference
