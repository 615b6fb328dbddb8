#pragma once

#include <optional>

#include "host/engine/lobe_query.h"
#include "host/engine/lobe_sampler.h"
#include "host/engine/make_patch_brdf.h"
#include "host/engine/map_batches.h"

namespace mica {

/// `beckmanns`: the BRDF of a mixture of Beckmann lobes, [Che18] Eq. 7, without Fresnel:
///     f_P(o, i) = D_P(h) / (4 I(o) I(i)),    I(o) = A_P(o) / G1(o) = integral of <o, w> D_P(w) dw    (Eq.
///     11),
/// in which the projected areas A_P cancel. Nothing bounces twice.
class BeckmannBrdf : public PatchBrdf {
 public:
  /// Builds the mixture and uploads it. Throws what `build_lobes` throws.
  BeckmannBrdf(Device& device, const Surface& surface, const PatchBrdfSettings& settings);

  std::vector<BrdfValue> evaluate(const std::vector<BrdfQuery>& queries) override;
  std::vector<Albedo> energy(const std::vector<ViewQuery>& queries) override;
  std::vector<BrdfSample> sample(const std::vector<SampleQuery>& queries) override;

  std::string name() const override { return "beckmanns"; }
  std::size_t device_bytes() const override { return densities_->device_bytes(); }
  double build_seconds() const override { return build_seconds_; }
  double device_seconds() const override { return densities_->device_seconds(); }

 private:
  /// I of both directions of a query.
  struct Areas {
    double view = 0, light = 0;
  };
  Areas geometric_areas(const BrdfQuery& query) const;

  Masking masking_;
  LobeStructure lobes_;  ///< also on the host: samples are drawn there
  LobeGrid grid_;
  LobeSampler sampler_;
  double squared_slope_ = 0;  ///< mean over the map
  double cutoff_, build_seconds_ = 0;
  std::optional<MapBatches<device_types::mica_lobe_query>> densities_;
};

}  // namespace mica
