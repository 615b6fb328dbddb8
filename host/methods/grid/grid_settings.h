#pragma once

#include "host/methods/grid/grid_evaluator.h"
#include "host/methods/settings.h"

namespace mica::host {

/// Settings of `grid`: glints without a map. [Kem25] Table 1.
class GridSettings : public SettingsOf<GridSettings> {
 public:
  void visit(SettingVisitor& visitor) override;
  Problem problem() const override;
  const GlintsDescription* glints() const override { return &glints_; }
  std::optional<double> own_roughness() const override { return microroughness_; }

 private:
  GlintsDescription glints_;
  double microroughness_ = 0.02;
};

/// What the kernel has to be able to do for these glints.
GridFeatures glint_features(const GlintsDescription& glints);
/// The same of the kernels that draw, which see no colours.
GridFeatures draw_features(const GlintsDescription& glints);

}  // namespace mica::host
