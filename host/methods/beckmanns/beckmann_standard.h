#pragma once

#include "host/methods/standard.h"
#include "host/reference/beckmann_mixture.h"
#include "host/surface/surface.h"

namespace mica::host {

/// `beckmanns` promises to be its own sum, but for what 16-bit slopes cost: half a unit, as far down a lobe's
/// flank as it is summed.
class BeckmannStandard : public Standard {
 public:
  BeckmannStandard(const Surface& surface, int elements);

  std::vector<double> references(const std::vector<Query>& queries) const override;
  Promise promise(double roughness) const override;
  std::string limitation(const std::vector<std::vector<Query>>& probes, const Query& worst,
                         double worst_error) const override;

 private:
  double quantised(double roughness) const;

  reference::BeckmannMixture mixture_;
  double leaf_slopes_;
};

}  // namespace mica::host
