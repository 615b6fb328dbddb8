#pragma once

#include <algorithm>
#include <optional>

#include "host/device/device.h"
#include "host/methods/evaluator.h"
#include "host/methods/map/map_batches.h"
#include "host/methods/standard.h"
#include "host/methods/triangles/triangle_precision.h"
#include "host/surface/surface.h"
#include "kernels/types.h"

namespace mica::host {

struct TriangleSettings {
  /// Relative L2 over queries whose half vectors hit, kExactTriangles to kRoughTriangles. A single answer is
  /// off by this of itself and this of its footprint's peak at most.
  double tolerance = kExactTriangles;
  std::size_t batch_queries =
      1 << 17;  ///< queries a launch, at most; less where the device's memory asks for it
  bool count_flops =
      false;  ///< densities become the floating-point operations of their integrals, for benchmarks
  std::optional<WaveForm> wave_form;  ///< default: what suits the device
};

/// `triangles`: the triangulated map, integrated exactly. [Yan14] Eq. 6; kernels/triangles/triangles.cl.
/// Normals less a half vector that turns are linear on a triangle, too, and a lobe that is not round is a
/// linear map of the disk.
class TriangleEvaluator : public Evaluator {
 public:
  /// Builds the map's structures and uploads them. `device` must outlive the evaluator.
  TriangleEvaluator(Device& device, const Surface& surface, const TriangleSettings& settings = {});
  /// On the structures of another one, which counts their bytes.
  TriangleEvaluator(Device& device, const TriangleEvaluator& same_map, const TriangleSettings& settings);

  std::unique_ptr<PendingDensities> start(const std::vector<Query>& queries) override;
  double error_estimate(const Query& query, double density) const override {
    return std::max(settings_.tolerance, relative_bound(query.roughness)) * density;
  }
  std::string name() const override { return "triangles"; }
  std::size_t device_bytes() const override { return batches_->device_bytes(); }
  double build_seconds() const override { return build_seconds_; }
  double device_seconds() const override;

 private:
  std::unique_ptr<PendingDensities> start_plain(const std::vector<Query>& queries);
  std::unique_ptr<PendingDensities> start_turned(const std::vector<Query>& queries);

  Device& device_;
  TriangleSettings settings_;
  Interpolation interpolation_;
  TrianglePrecision precision_;
  double build_seconds_ = 0;
  std::optional<MapBatches<device_types::mica_map_query>> batches_;
  std::optional<MapBatches<device_types::mica_turned_query>> turned_;  // compiled for the first of them
};

}  // namespace mica::host
