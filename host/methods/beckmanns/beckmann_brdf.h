#pragma once

#include <optional>

#include "host/base/masking.h"
#include "host/base/stopwatch.h"
#include "host/methods/beckmanns/lobe_query.h"
#include "host/methods/beckmanns/lobe_sampler.h"
#include "host/methods/beckmanns/slope_footprint.h"
#include "host/methods/map/map_batches.h"
#include "host/methods/patch_brdf.h"

namespace mica::host {

struct BeckmannBrdfSettings {
  Masking masking = Masking::exact;
  EnergyBound energy_bound = EnergyBound::none;  ///< exact masking needs none
  int elements = 1;                              ///< lobes a texel and axis
  std::optional<WaveForm> wave_form = {};        ///< default: what suits the device
};

/// `beckmanns`: the BRDF of a mixture of Beckmann lobes, [Che18] Eq. 7, without Fresnel:
///     f_P(o, i) = D_P(h) / (4 I(o) I(i)),   I(o) = A_P(o) / G1(o) = integral of <o, w> D_P(w) dw   (Eq. 11),
/// in which the projected areas A_P cancel. A patch receives light by its own cosine, A_P(i), and not by i.g:
/// answers are f_P(o, i) A_P(i), with which no patch scatters more than it gets (docs/accuracy.md). With
/// `geometric` masking A_P(i) is i.g. Nothing bounces twice.
///
/// With a bound I(o) and I(i) are no less than those of exact masking: since the integral of <o, h> D(h) over
/// the normals is I(o), and A(i) <= I(i) with every masking, all lights together are then at most one. The
/// BRDF stays symmetric, and each answer is asked for twice.
class BeckmannBrdf : public PatchBrdf {
 public:
  /// Builds the mixture and uploads it. Throws what `build_lobes` throws.
  BeckmannBrdf(Device& device, const Surface& surface, const BeckmannBrdfSettings& settings);

  std::vector<BrdfValue> evaluate(const std::vector<BrdfQuery>& queries) override;
  std::vector<Albedo> energy(const std::vector<ViewQuery>& queries) override;
  std::vector<BrdfSample> sample(const std::vector<SampleQuery>& queries) override;

  std::string name() const override { return "beckmanns"; }
  std::size_t device_bytes() const override { return device_bytes_; }
  double build_seconds() const override { return build_seconds_; }
  double device_seconds() const override;

 private:
  using Patches = MapBatches<device_types::mica_patch_query>;

  /// D of a query's half vector, I of its directions, and the projected area A(i) of the mean normal.
  struct Parts {
    double density = 0, view_area = 0, light_area = 0, light_projected = 0;
  };
  /// @param queries with both directions above the horizon.
  std::vector<Parts> parts(const std::vector<BrdfQuery>& queries);
  std::vector<Parts> geometric_parts(const std::vector<BrdfQuery>& queries);
  Albedo albedo(const ViewQuery& from);
  /// @param masking of `patches`: exact or filtered.
  std::vector<Parts> patch_parts(const std::vector<BrdfQuery>& queries, Masking masking, Patches* patches);

  Masking masking_;
  Stopwatch watch_;      ///< of the constructor
  LobeStructure lobes_;  ///< also on the host: samples are drawn there
  LobeGrid grid_;
  LobeSampler sampler_;
  std::vector<SlopeLevel> levels_;
  double squared_slope_ = 0;  ///< mean over the map
  double cutoff_, build_seconds_ = 0;
  std::size_t device_bytes_ = 0;
  std::optional<MapBatches<device_types::mica_lobe_query>> densities_;  ///< `geometric`
  std::optional<Patches> patches_;                                      ///< the others
  std::optional<Patches> bound_;                                        ///< exact, beside one of these
};

}  // namespace mica::host
