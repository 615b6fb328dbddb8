#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "host/methods/beckmanns/beckmann_brdf.h"
#include "host/methods/beckmanns/beckmann_evaluator.h"
#include "host/methods/beckmanns/beckmann_settings.h"
#include "host/methods/beckmanns/beckmann_standard.h"
#include "host/methods/beckmanns/lobes.h"
#include "host/methods/beckmanns/slope_pyramid.h"
#include "host/methods/method.h"
#include "host/reference/beckmann_mixture.h"

namespace mica::host {
namespace {

class BeckmannsMethod : public Method {
 public:
  std::string name() const override { return "beckmanns"; }
  std::string summary() const override {
    return "a mixture of Beckmann lobes, with a BRDF and masking of its own [Che18]";
  }
  MethodTraits traits() const override {
    MethodTraits traits;
    traits.brdf = traits.lit_by_brdf = traits.brdf_references = true;
    return traits;
  }
  bool takes(Interpolation interpolation) const override { return interpolation != Interpolation::bicubic; }
  std::unique_ptr<MethodSettings> settings() const override { return std::make_unique<BeckmannSettings>(); }

  /// Geometric masking knows one roughness for the whole map, filtered masking one lobe for a patch: only
  /// exact masking is normalised by itself.
  bool conserves_energy(const MethodSettings& settings) const override {
    const auto& own = settings_as<BeckmannSettings>(settings);
    return own.masking == Masking::exact || own.energy_bound == EnergyBound::patch;
  }

  /// Of exact masking, which is what others approximate.
  std::vector<double> brdf_references(const std::vector<BrdfQuery>& queries, const Surface& surface,
                                      const MethodSettings& settings) const override {
    const reference::BeckmannMixture mixture(surface, settings_as<BeckmannSettings>(settings).elements);
    std::vector<double> references(queries.size());
    tbb::parallel_for(std::size_t{0}, queries.size(), [&](std::size_t n) {
      const BrdfQuery& query = queries[n];
      references[n] = reference::BeckmannMixture::scattering(mixture.lobes(query.footprint, query.roughness),
                                                             query.view, query.light);
    });
    return references;
  }

  StructureSize structure(const StructureAsked& asked, const MethodSettings& settings) const override {
    const auto& own = settings_as<BeckmannSettings>(settings);
    StructureSize size;
    size.device_bytes =
        (asked.densities ? 2 : 1) * lobe_structure_bytes(asked.width, asked.height, own.elements);
    size.kernel = "beckmanns/beckmanns.cl";
    if (own.masking != Masking::geometric || own.energy_bound == EnergyBound::patch)
      size.device_bytes +=
          slope_pyramid_bytes(asked.width * own.elements, asked.height * own.elements, false);
    if (own.masking != Masking::geometric) size.kernel = "beckmanns/beckmann_patches.cl";
    return size;
  }

  std::unique_ptr<Evaluator> make_own(Device* device, const Surface* surface,
                                      const MethodSettings& settings) const override {
    MixtureSettings mixture;
    mixture.elements = settings_as<BeckmannSettings>(settings).elements;
    return std::make_unique<BeckmannEvaluator>(*device, *surface, mixture);
  }

  std::unique_ptr<PatchBrdf> make_own_brdf(Device* device, const Surface* surface,
                                           const MethodSettings& settings) const override {
    const auto& own = settings_as<BeckmannSettings>(settings);
    BeckmannBrdfSettings brdf;
    brdf.masking = own.masking, brdf.energy_bound = own.energy_bound, brdf.elements = own.elements;
    return std::make_unique<BeckmannBrdf>(*device, *surface, brdf);
  }

  std::unique_ptr<Standard> standard(const Surface* surface, const reference::Oracle*,
                                     const MethodSettings& settings) const override {
    return std::make_unique<BeckmannStandard>(*surface, settings_as<BeckmannSettings>(settings).elements);
  }

  std::vector<MethodVariant> variants(const std::vector<int>& elements) const override {
    return element_variants<BeckmannSettings>(name(), elements);
  }
};

}  // namespace

std::shared_ptr<const Method> beckmanns_method() {
  return std::make_shared<BeckmannsMethod>();
}

}  // namespace mica::host
