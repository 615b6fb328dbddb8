#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "host/base/query.h"

namespace mica::host {

/// What a patch BRDF answers to a BrdfQuery: radiance to the view by unit radiance from the light, a
/// steradian. The cosine in it is that of the model: i.g, or the projected area of what the footprint sees
/// (`beckmanns`). Light that bounced once takes Fresnel's factor at the half
/// vector; light that bounced more often takes one of its own, so the parts are kept apart.
struct BrdfValue {
  float single = 0;    ///< f_P(o, i) times the patch's cosine, of light that bounced once, without Fresnel
  float multiple = 0;  ///< the same of light that bounced more often; 0 for models without it
  float pdf = 0;       ///< with which `sample` draws i, per steradian
  Eigen::Vector3f tint = Eigen::Vector3f::Ones();  ///< of the facets that mirror i, where they have colours
};

/// Shares of the light that a white patch scatters to a view. [Che19] Eqs. 15 and 18.
struct Albedo {
  float single = 0;  ///< by one bounce
  float lost = 0;    ///< what one bounce loses
};

/// A direction drawn with the density `pdf` per steradian. Weights are `evaluate`'s parts over it.
struct BrdfSample {
  Eigen::Vector3f light = Eigen::Vector3f::Zero();
  float pdf = 0;  ///< 0: nothing was drawn (the direction fell below the horizon); weights are 0 then
  float weight_single = 0, weight_multiple = 0;
  Eigen::Vector3f tint = Eigen::Vector3f::Ones();
};

/// A BRDF that is normalised for the patch of surface that a footprint sees. Answers depend on the query
/// alone: not on the batch it is in, its place there, or the number of threads; all are finite and >= 0, in
/// the order of the queries.
class PatchBrdf {
 public:
  virtual ~PatchBrdf() = default;

  virtual std::vector<BrdfValue> evaluate(const std::vector<BrdfQuery>& queries) = 0;
  virtual std::vector<Albedo> energy(const std::vector<ViewQuery>& queries) = 0;
  virtual std::vector<BrdfSample> sample(const std::vector<SampleQuery>& queries) = 0;

  /// Answers so far that were not finite, and were replaced by 0 or by a definition's; see
  /// with_finite_answers.
  virtual std::size_t replaced() const { return 0; }

  virtual std::string name() const = 0;
  virtual std::size_t device_bytes() const = 0;  ///< of its structures, without batches
  virtual double build_seconds() const = 0;      ///< that its structures took on the host
  virtual double device_seconds() const = 0;     ///< that its kernels ran so far, by the device's own clock
};

}  // namespace mica::host
