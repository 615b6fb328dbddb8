#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/device/device.h"
#include "host/methods/evaluator.h"
#include "host/methods/grid/grid_query.h"

namespace mica::host {

/// What the kernel is compiled for.
struct GridFeatures {
  int colors = 1;         ///< of glints, 1 to 8; each glint has one of them, at random
  bool roulette = false;  ///< points with a share or a part of their glints
};

/// Replaces densities that are not finite by those of the definition, in double precision.
/// @param rows a density a query, for each colour. @param points one for all queries, or one for each.
/// Returns how many queries had one.
std::size_t replace_what_is_not_finite(const std::vector<Query>& queries,
                                       const std::vector<GlintPoint>& points,
                                       std::vector<std::vector<float>>* rows);

std::string grid_kernel_options(Distribution distribution, const GridFeatures& features);

class PendingGrid;

/// `grid`: glints on an implicit grid, without a map, a precomputation or memory. [Kem25];
/// kernels/grid/grid.cl.
class GridEvaluator : public Evaluator {
 public:
  /// @param batch_queries queries a launch, at most. Throws UsageError for a grid with a problem. `device`
  /// must outlive the evaluator.
  GridEvaluator(Device& device, const GlintGrid& grid, std::optional<WaveForm> wave_form = {},
                std::size_t batch_queries = 1 << 18, GridFeatures features = {});

  /// All queries must pass `grid_query_problem`.
  std::unique_ptr<PendingDensities> start(const std::vector<Query>& queries) override;
  /// @param points what the glints are at each query; all of the evaluator's distribution.
  std::unique_ptr<PendingDensities> start_at(const std::vector<Query>& queries,
                                             const std::vector<GlintPoint>& points) override;
  std::size_t replaced() const override { return *replaced_; }
  std::string name() const override { return "grid"; }
  std::size_t device_bytes() const override { return 0; }
  double build_seconds() const override { return 0; }
  double device_seconds() const override { return *device_seconds_; }

 private:
  void enqueue(cl::Kernel* kernel, std::size_t begin, std::size_t end, PendingGrid* pending);
  void enqueue_batch(cl::Kernel* kernel, GridBatch batch, std::size_t first, std::size_t count,
                     PendingGrid* pending);

  Device& device_;
  GlintGrid grid_;
  GridFeatures features_;
  WaveForm wave_form_;
  std::size_t batch_queries_;
  // Shared with pending densities.
  std::shared_ptr<double> device_seconds_ = std::make_shared<double>(0.0);
  std::shared_ptr<std::size_t> replaced_ = std::make_shared<std::size_t>(0);
  cl::Kernel kernel_;
  std::optional<cl::Kernel> turned_;  // made for the first query that turns
};

}  // namespace mica::host
