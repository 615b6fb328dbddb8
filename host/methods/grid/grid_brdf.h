#pragma once

#include "host/base/glints_description.h"
#include "host/methods/grid/grid_evaluator.h"
#include "host/methods/patch_brdf.h"

namespace mica::host {

/// The process that a material's glints are, where it has no textures.
GlintGrid grid_of(const GlintsDescription& glints);

/// `grid`: the BRDF of glints without a map, [Kem25] Eq. 1, without Fresnel: D(h) G(o, i) / (4 o.g i.g). It
/// is not normalised: a footprint with many bright glints may send out more light than it gets, one with few
/// less; the mean over a surface is that of the smooth distribution. Nothing bounces twice.
///
/// Draws follow the glints [Kem25 sec. 3.3.5]; see kernels/grid/grid_brdf.cl. The roughness of queries is the
/// microroughness. Glints that are drawn have no colours; what answers say of a direction has:
/// BrdfValue::tint.
class GridBrdf : public PatchBrdf {
 public:
  /// @param device must outlive it. Throws UsageError for glints with a problem.
  GridBrdf(Device& device, const GlintsDescription& glints, std::size_t batch_queries = 1 << 17);

  /// All queries must pass `grid_query_problem`, for any half vector.
  std::vector<BrdfValue> evaluate(const std::vector<BrdfQuery>& queries) override;
  /// Estimated by `kAlbedoDraws` draws a view, the same for all: 4% of noise at a footprint of one cell.
  std::vector<Albedo> energy(const std::vector<ViewQuery>& queries) override;
  std::vector<BrdfSample> sample(const std::vector<SampleQuery>& queries) override;

  std::size_t replaced() const override { return densities_.replaced(); }
  std::string name() const override { return "grid"; }
  std::size_t device_bytes() const override { return 0; }
  double build_seconds() const override { return 0; }
  double device_seconds() const override { return densities_.device_seconds() + device_seconds_; }

  static constexpr int kAlbedoDraws = 4096;

 private:
  /// Rows of one of the kernels of grid_brdf.cl.
  std::vector<std::vector<float>> run(cl::Kernel* kernel, const GridBatch& batch, std::size_t count,
                                      std::size_t rows);
  Eigen::Vector3f tint(const PendingDensities& densities, std::size_t query) const;
  std::vector<Eigen::Vector2d> draw(const std::vector<SampleQuery>& queries);
  std::vector<float> draw_densities(const std::vector<Query>& queries, const std::vector<GlintPoint>& points);

  Device& device_;
  GlintsDescription glints_;
  GlintPoint point_;  // of queries that bring none
  std::size_t batch_queries_;
  GridEvaluator densities_;
  cl::Kernel draw_, draw_density_;
  double device_seconds_ = 0;
};

}  // namespace mica::host
