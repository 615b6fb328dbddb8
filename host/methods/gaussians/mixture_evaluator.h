#pragma once

#include <optional>

#include "host/device/device.h"
#include "host/methods/evaluator.h"
#include "host/methods/map/map_batches.h"
#include "host/surface/surface.h"

namespace mica::host {

struct MixtureSettings {
  int elements = 1;  ///< a texel and axis, 1 to kMaxElements
  /// Weight e, of the largest, at which culling may drop an element: at most e (1 - ln e) of the
  /// integral, 9.3e-4. It tells leaves from afar and drops less: 2e-5.
  double cutoff_error = 9e-5;
  std::size_t batch_queries = 1 << 17;  ///< queries a launch, at most
  bool count_elements = false;          ///< densities become the numbers of elements summed, for benchmarks
  std::optional<WaveForm> wave_form;    ///< default: what suits the device
};

/// `gaussians`: a mixture of 4D Gaussians in position and normal. [Yan16]; kernels/gaussians/gaussians.cl.
class GaussianEvaluator : public Evaluator {
 public:
  /// Builds the mixture and uploads it. `device` must outlive the evaluator. Throws what
  /// `build_gaussian_mixture` throws.
  GaussianEvaluator(Device& device, const Surface& surface, const MixtureSettings& settings = {});

  std::unique_ptr<PendingDensities> start(const std::vector<Query>& queries) override;
  std::string name() const override { return "gaussians"; }
  std::size_t device_bytes() const override { return batches_->device_bytes(); }
  double build_seconds() const override { return build_seconds_; }
  double device_seconds() const override;

 private:
  std::unique_ptr<PendingDensities> start_plain(const std::vector<Query>& queries);
  std::unique_ptr<PendingDensities> start_turned(const std::vector<Query>& queries);

  Device& device_;
  MixtureSettings settings_;
  Interpolation interpolation_;
  int elements_;
  double cutoff_, build_seconds_ = 0;
  std::optional<MapBatches<device_types::mica_mixture_query>> batches_;
  std::optional<MapBatches<device_types::mica_turned_mixture_query>>
      turned_;  // compiled for the first of them
};

}  // namespace mica::host
