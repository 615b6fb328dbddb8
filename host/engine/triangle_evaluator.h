#pragma once

#include <optional>

#include "host/device/device.h"
#include "host/engine/evaluator.h"
#include "host/surface/surface.h"
#include "kernels/types.h"

namespace mica {

struct TriangleSettings {
  /// Weight, of the largest, at which culling may drop a texel. Many texels can lie just beyond the cutoff:
  /// the most that was seen to be lost is twelve times this, of the density's peak.
  double cutoff_error = 2.5e-8;
  std::size_t batch_queries =
      1 << 17;  ///< queries a launch, at most; less where the device's memory asks for it
  bool count_flops =
      false;  ///< densities become the floating-point operations of their integrals, for benchmarks
  std::optional<WaveForm> wave_form;  ///< default: what suits the device
};

class TriangleDensities;

/// `triangles`: the triangulated map, integrated exactly. [Yan14] Eq. 6; kernels/triangles.cl.
class TriangleEvaluator : public Evaluator {
 public:
  /// Builds the map's structures and uploads them. `device` must outlive the evaluator.
  TriangleEvaluator(Device& device, const Surface& surface, const TriangleSettings& settings = {});

  std::unique_ptr<PendingDensities> start(const std::vector<Query>& queries) override;
  std::string name() const override { return "triangles"; }
  std::size_t device_bytes() const override { return device_bytes_; }

  double build_seconds() const override { return build_seconds_; }
  double device_seconds() const override { return *device_seconds_; }
  std::size_t batch_queries() const { return batch_queries_; }

 private:
  void enqueue(std::size_t first, TriangleDensities* pending);

  Device& device_;
  Interpolation interpolation_;
  WaveForm wave_form_;
  device_types::mica_map_grid grid_{};
  double cutoff_;
  std::size_t batch_queries_, device_bytes_;
  double build_seconds_;
  std::shared_ptr<double> device_seconds_ = std::make_shared<double>(0.0);  // shared with pending densities
  cl::Buffer normals_, block_nodes_, tile_nodes_;
  cl::Kernel kernel_;
};

}  // namespace mica
