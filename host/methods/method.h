#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "host/base/query.h"
#include "host/methods/settings.h"
#include "host/surface/description.h"

namespace mica::host {

namespace reference {
class Oracle;
}
class Device;
class Evaluator;
class PatchBrdf;
class Standard;
class Surface;

/// What a method is, as far as others have to know.
struct MethodTraits {
  bool map = true;                ///< it reads a normal map; else it has glints without one
  bool densities = true;          ///< it answers D
  bool brdf = false;              ///< it has a BRDF of its own
  bool lit_by_brdf = false;       ///< a job's lights are multiplied with that BRDF, and not with a density
  bool brdf_references = false;   ///< it has those
  bool device = true;             ///< it runs on a device
  bool jobs = true;               ///< materials may name it
  bool compared = true;           ///< benchmarks and hard cases ask it
  bool estimates_errors = false;  ///< of single answers: Evaluator::error_estimate
  bool chooses = false;           ///< it chooses among others: Evaluator::calibrate
  bool surface_normals =
      false;  ///< its density is that of the map's normals, from which directions are drawn
  bool keeps_tolerance = false;  ///< it takes a relative error to keep: MethodSettings::tolerance
  bool first_order = false;      ///< half vectors may turn over a footprint, and lobes need not be round
};

/// What a method would build on a surface.
struct StructureAsked {
  int width = 0, height = 0;  ///< texels
  Interpolation interpolation = Interpolation::bilinear;
  bool densities = false, brdf = false;  ///< what a job asks of it
};
struct StructureSize {
  std::size_t device_bytes = 0;
  std::size_t host_bytes = 0;  ///< besides the surface
  std::string kernel;          ///< files and options; several with commas between them
};

/// A method with other settings, as benchmarks show it beside others.
struct MethodVariant {
  std::unique_ptr<MethodSettings> settings;
  std::string label, knob;  ///< "gaussians, 2 a texel and axis", "2"
};

/// An evaluator whose densities are counts, and what one of them is in floating-point operations.
struct OperationCounter {
  std::unique_ptr<Evaluator> evaluator;  ///< null: the method counts nothing
  double flops_a_count = 0;
};

/// One way to answer for a surface's normals: everything that jobs, the command line, benchmarks, the
/// selftest and the documentation know of it. A method is found by its name in a MethodRegistry; nobody
/// compares names.
class Method {
 public:
  virtual ~Method() = default;

  virtual std::string name() const = 0;
  virtual std::string summary() const = 0;  ///< one line for lists
  virtual MethodTraits traits() const = 0;
  virtual bool takes(Interpolation) const { return true; }

  /// Its settings as they are by default; `check` refuses those that it cannot work by with a UsageError.
  virtual std::unique_ptr<MethodSettings> settings() const;
  virtual void check(const MethodSettings& settings) const;

  virtual StructureSize structure(const StructureAsked& asked, const MethodSettings& settings) const = 0;

  /// Whether materials with these settings may share what is made. @param gathers light from all around.
  virtual bool share(const MethodSettings& a, const MethodSettings& b, bool gathers) const;
  /// Whether its BRDF never scatters more than it receives.
  virtual bool conserves_energy(const MethodSettings&) const { return true; }

  /// Answers that are not finite are replaced and counted: by the oracle's (Evaluator::replaced), or by 0 of
  /// a BRDF (PatchBrdf::replaced).
  /// @param device, surface have to outlive what is made; null where the traits say that it needs none.
  /// Throws UsageError where the method has no such thing, and for a surface or settings that it does not
  /// take.
  std::unique_ptr<Evaluator> make(Device* device, const Surface* surface,
                                  const MethodSettings& settings) const;
  std::unique_ptr<PatchBrdf> make_brdf(Device* device, const Surface* surface,
                                       const MethodSettings& settings) const;

  /// Why a query cannot be answered, or empty when it can. @param surface null without a map.
  std::string query_problem(const Query& query, const Surface* surface) const;

  /// What its answers are held to, or null: it approximates the map and promises nothing. @param map the
  /// oracle of `surface`; both have to outlive the standard, and are null without a map.
  virtual std::unique_ptr<Standard> standard(const Surface* surface, const reference::Oracle* map,
                                             const MethodSettings& settings) const;

  /// f(o, i) cos of light that bounced once, without Fresnel's factor, by the BRDF's own definition in double
  /// precision; empty where there is none to compare with.
  virtual std::vector<double> brdf_references(const std::vector<BrdfQuery>& /*queries*/,
                                              const Surface& /*surface*/,
                                              const MethodSettings& /*settings*/) const {
    return {};
  }

  /// Settings that make it as hard as a map of this size.
  virtual std::unique_ptr<MethodSettings> settings_beside(int /*width*/, int /*height*/) const {
    return settings();
  }

  /// What benchmarks show of it. @param elements of mixtures, a texel and axis.
  virtual std::vector<MethodVariant> variants(const std::vector<int>& elements) const;
  virtual OperationCounter counter(Device* device, const Surface* surface,
                                   const MethodSettings& settings) const;

 protected:
  /// The same but for what the traits exclude already.
  virtual std::string own_query_problem(const Query& query, const Surface* surface) const;
  /// `make`, with answers as they come.
  virtual std::unique_ptr<Evaluator> make_own(Device* device, const Surface* surface,
                                              const MethodSettings& settings) const;
  virtual std::unique_ptr<PatchBrdf> make_own_brdf(Device* device, const Surface* surface,
                                                   const MethodSettings& settings) const;
  [[noreturn]] void refuse_brdf() const;
  [[noreturn]] void refuse_densities() const;
};

/// The map's problem of a query for a BRDF's view: its half vector does not matter.
std::string view_problem(const Method& method, const ViewQuery& query, const Surface* surface);

/// The settings as the type that their method made. Throws UsageError when they are another method's.
template <typename Settings>
const Settings& settings_as(const MethodSettings& settings);

[[noreturn]] void refuse_settings();

template <typename Settings>
const Settings& settings_as(const MethodSettings& settings) {
  const auto* const own = dynamic_cast<const Settings*>(&settings);
  if (own == nullptr) refuse_settings();
  return *own;
}

}  // namespace mica::host
