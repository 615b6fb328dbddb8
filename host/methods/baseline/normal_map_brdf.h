#pragma once

#include <string>
#include <vector>

#include "host/methods/patch_brdf.h"
#include "host/surface/surface.h"

namespace mica::host {

/// Classic normal mapping, a baseline: a footprint has one normal n', that of the map at its middle, and
/// f max(i.n', 0) = D(h) G(o, i) / (4 o.n') is a smooth microfacet BRDF about it: a Beckmann lobe of the
/// query's roughness. The footprint's extent does not count. What n' mirrors below the geometric horizon is
/// lost, and nothing is seen by a view from below n'.
class NormalMapBrdf : public PatchBrdf {
 public:
  explicit NormalMapBrdf(const Surface& surface);

  std::vector<BrdfValue> evaluate(const std::vector<BrdfQuery>& queries) override;
  /// By a thousand draws, spread evenly: good to half a percent.
  std::vector<Albedo> energy(const std::vector<ViewQuery>& queries) override;
  std::vector<BrdfSample> sample(const std::vector<SampleQuery>& queries) override;

  std::string name() const override { return "normalmap"; }
  std::size_t device_bytes() const override { return 0; }
  double build_seconds() const override { return 0; }
  double device_seconds() const override { return 0; }

 private:
  Eigen::Matrix3d to_shading_frame(const Footprint& footprint) const;
  BrdfValue value(const BrdfQuery& query) const;
  BrdfSample draw(const ViewQuery& from, const Eigen::Vector2d& uniform) const;

  Surface surface_;
};

}  // namespace mica::host
