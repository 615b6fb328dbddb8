#pragma once

#include <optional>

#include "host/device/device.h"
#include "host/methods/beckmanns/lobe_query.h"
#include "host/methods/evaluator.h"
#include "host/methods/gaussians/mixture_evaluator.h"
#include "host/methods/map/map_batches.h"
#include "host/surface/surface.h"

namespace mica::host {

/// `beckmanns`: a mixture of non-centred anisotropic Beckmann lobes. [Che18]; kernels/beckmanns/beckmanns.cl.
class BeckmannEvaluator : public Evaluator {
 public:
  /// Builds the mixture and uploads it. `device` must outlive the evaluator. Throws what `build_lobes`
  /// throws.
  BeckmannEvaluator(Device& device, const Surface& surface, const MixtureSettings& settings = {});

  std::unique_ptr<PendingDensities> start(const std::vector<Query>& queries) override;
  std::string name() const override { return "beckmanns"; }
  std::size_t device_bytes() const override { return batches_->device_bytes(); }
  double build_seconds() const override { return build_seconds_; }
  double device_seconds() const override { return batches_->device_seconds(); }

 private:
  std::unique_ptr<PendingDensities> start_plain(const std::vector<Query>& queries);

  LobeGrid grid_;
  double cutoff_, build_seconds_ = 0;
  std::optional<MapBatches<device_types::mica_lobe_query>> batches_;
};

}  // namespace mica::host
