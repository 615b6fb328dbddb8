#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "mica/control.h"
#include "mica/device.h"
#include "mica/method.h"
#include "mica/query.h"
#include "mica/settings.h"
#include "mica/surface.h"

MICA_BEGIN_NAMESPACE

/// Which part of a BRDF: light that bounced once, more often, or both.
enum class BrdfPart { single, multiple, all };

/// What a footprint as a whole does to light, by a method that has a BRDF of its own: "beckmanns",
/// "cavities", "normalmap", or "grid" without a map. Keeps its device and its map alive. Copies are the same
/// BRDF; calls from several threads wait for each other. Fresnel's factor is not in it.
class MICA_API Brdf {
 public:
  /// Throws UsageError and DeviceError.
  Brdf(const Device& device, const NormalMap& map, const std::string& method, const Settings& settings = {},
       const Methods& methods = {});
  Brdf(const Device& device, const std::string& method, const Settings& settings = {},
       const Methods& methods = {});

  /// f(o, i) times the light's cosine, of each: max(i.g, 0), or the projected area that "beckmanns" has of
  /// what the footprint sees. Throws UsageError, which names the first query that cannot be answered.
  void evaluate(const Lightings& queries, Span<float> values, BrdfPart part = BrdfPart::all,
                const RunControl& control = {}) const;
  /// What a white patch scatters to the view at once, and what that loses: 2 numbers a view.
  void energy(const Views& views, Span<float> albedos, const RunControl& control = {}) const;
  /// Directions towards the light: ix iy iz pdf weight, 5 numbers a view; pdf 0: nothing was drawn.
  /// @param seed draw n of a seed is always the same.
  void sample(const Views& views, std::uint64_t seed, Span<float> samples,
              const RunControl& control = {}) const;

  std::string method() const;
  std::size_t device_bytes() const;
  double build_seconds() const;
  double device_seconds() const;

  class Implementation;

 private:
  std::shared_ptr<Implementation> implementation_;
};

MICA_END_NAMESPACE
