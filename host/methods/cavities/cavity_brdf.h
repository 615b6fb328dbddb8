#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/base/cavities.h"
#include "host/device/device.h"
#include "host/methods/cavities/cavity_query.h"
#include "host/methods/cavities/compensation.h"
#include "host/methods/map/map_batches.h"
#include "host/methods/patch_brdf.h"
#include "host/surface/surface.h"

namespace mica::host {

struct CavitySettings {
  Compensation compensation = Compensation::diffuse;
  double compensation_width = kMirrorWidth;  ///< of the specular one, in roughnesses
  LostEnergy energy = LostEnergy::exact;
  int per_texel = 1;  ///< seeds a texel and axis, 1 or 2: [Che19]'s spacing h is 1 or 0.5
  /// Weight, of the largest, at which culling may drop a seed.
  double cutoff_error = 1e-6;
  std::size_t batch_queries = 1 << 17;  ///< queries a launch, at most
  bool count_elements = false;          ///< `single` becomes the number of seeds evaluated, for benchmarks
  std::optional<WaveForm> wave_form;    ///< default: what suits the device
};

/// `cavities`: light that bounces inside V-shaped cavities, whose facets are a map's normals and their
/// symmetric duals. [Che19]; kernels/cavities/cavities.cl. Light that bounced once is computed; what it loses
/// leaves by the lobe of the compensation. With F the Fresnel factor of the material, [Che19] Eq. 11 is
/// F(o.h) single + F(o.g) multiple.
///
/// Directions are drawn by [Che19] Algorithm 1: with `exact` their density is single + multiple. It is the
/// same draw with `sampled`, whose `pdf` is off by as much as its lost energy. Weights are 1 for the sum of
/// both parts, whatever the view.
class CavityBrdf : public PatchBrdf {
 public:
  /// Builds the structures and uploads them. `device` must outlive it. Throws UsageError for a number of
  /// seeds other than 1 and 2, and for two of a bicubic surface.
  CavityBrdf(Device& device, const Surface& surface, const CavitySettings& settings = {});

  std::vector<BrdfValue> evaluate(const std::vector<BrdfQuery>& queries) override;
  std::vector<Albedo> energy(const std::vector<ViewQuery>& queries) override;
  std::vector<BrdfSample> sample(const std::vector<SampleQuery>& queries) override;

  std::string name() const override { return "cavities"; }
  std::size_t device_bytes() const override { return bounces_->device_bytes(); }
  double build_seconds() const override { return build_seconds_; }
  double device_seconds() const override;

 private:
  /// What the queries at the places `asked` are answered.
  template <typename DeviceQuery, typename Translate>
  std::vector<float> ask(MapBatches<DeviceQuery>* batches, const std::vector<ViewQuery>& queries,
                         const std::vector<std::size_t>& asked, const Translate& translate) const;
  std::vector<Eigen::Vector3d> draw(const std::vector<SampleQuery>& queries);

  Compensation compensation_;
  CavityGrid cavities_;
  double cutoff_, build_seconds_ = 0;
  std::optional<MapBatches<device_types::mica_map_query>> bounces_;
  std::optional<MapBatches<device_types::mica_cavity_query>> energies_, draws_;
  std::optional<MapBatches<device_types::mica_sampled_cavity_query>> sampled_energies_;
};

}  // namespace mica::host
