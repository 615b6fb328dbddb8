#pragma once

#include <optional>

#include "host/device/device.h"
#include "host/methods/beckmanns/lobe_query.h"
#include "host/methods/beckmanns/slope_footprint.h"
#include "host/methods/evaluator.h"
#include "host/methods/gaussians/mixture_evaluator.h"
#include "host/methods/map/map_batches.h"
#include "host/surface/surface.h"

namespace mica::host {

/// `smooth`: one Beckmann lobe a footprint, with the mean and the covariance of its slopes;
/// kernels/smooth/smooth.cl.
class SmoothEvaluator : public Evaluator {
 public:
  /// Builds the pyramid of slopes and uploads it. `device` must outlive the evaluator. Throws what
  /// `build_lobes` throws.
  SmoothEvaluator(Device& device, const Surface& surface, const MixtureSettings& settings = {});

  std::unique_ptr<PendingDensities> start(const std::vector<Query>& queries) override;
  std::string name() const override { return "smooth"; }
  std::size_t device_bytes() const override { return batches_->device_bytes(); }
  double build_seconds() const override { return build_seconds_; }
  double device_seconds() const override;

 private:
  std::unique_ptr<PendingDensities> start_plain(const std::vector<Query>& queries);
  std::unique_ptr<PendingDensities> start_turned(const std::vector<Query>& queries);
  device_types::mica_smooth_query plain(const Query& query, const Footprint& footprint) const;
  device_types::mica_turned_smooth_query turned(const Query& query) const;

  Device& device_;
  WaveForm wave_form_;
  std::size_t batch_queries_;
  LobeGrid grid_;
  std::vector<SlopeLevel> levels_;
  double build_seconds_ = 0;
  std::optional<MapBatches<device_types::mica_smooth_query>> batches_;
  std::optional<MapBatches<device_types::mica_turned_smooth_query>>
      turned_;  // compiled for the first of them
};

}  // namespace mica::host
