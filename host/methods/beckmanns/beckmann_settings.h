#pragma once

#include "host/base/masking.h"
#include "host/methods/gaussians/mixture_settings.h"

namespace mica::host {

/// Settings of `beckmanns`, for jobs and calls.
class BeckmannSettings : public SettingsOf<BeckmannSettings> {
 public:
  void visit(SettingVisitor& visitor) override {
    visitor.choice("masking",
                   "Of a BRDF: of every lobe under the footprint, of one lobe with their moments, or of the "
                   "map's roughness",
                   masking);
    visitor.choice(visitor.source() == SettingSource::job ? "energy_bound" : "energy-bound",
                   "Of masking that is an approximation: whether a patch may scatter more than it gets",
                   energy_bound);
    visit_elements(visitor, elements);
  }

  Masking masking = Masking::exact;
  EnergyBound energy_bound = EnergyBound::none;
  int elements = 1;
};

}  // namespace mica::host
