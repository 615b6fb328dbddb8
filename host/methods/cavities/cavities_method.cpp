#include <fmt/format.h>

#include "host/methods/cavities/cavity_brdf.h"
#include "host/methods/map/map_structure.h"
#include "host/methods/method.h"
#include "host/reference/cavity.h"

namespace mica::host {
namespace {

/// Settings of `cavities`. A job says how far seeds lie apart, a call how many there are.
class CavityMethodSettings : public SettingsOf<CavityMethodSettings> {
 public:
  void visit(SettingVisitor& visitor) override {
    visitor.choice("compensation", "Of cavities, where light goes that bounces more than once", compensation);
    visitor.number(visitor.source() == SettingSource::job ? "compensation_width" : "compensation-width",
                   "Of the specular compensation of cavities: standard deviation in roughnesses",
                   compensation_width, {0, 1000, true});
    visitor.choice("energy",
                   "Of cavities, what one bounce loses: of every seed under the footprint, or of some",
                   energy);
    if (visitor.source() == SettingSource::job) {
      visitor.number("spacing", "Of seeds, in texels: 1 or 0.5", spacing_texels, {0, 1, true});
      per_texel = spacing_texels == 1 ? 1 : 2;
    } else {
      visitor.whole("elements", "Seeds of cavities, a texel and axis: 1 or 2", per_texel, 1, 4);
    }
  }

  Problem problem() const override {
    if (spacing_texels == 1 || spacing_texels == 0.5) return {};
    return {"spacing", fmt::format("found {}; expected 1 or 0.5 texels", spacing_texels)};
  }

  Compensation compensation = Compensation::diffuse;
  double compensation_width = kMirrorWidth;
  LostEnergy energy = LostEnergy::exact;
  double spacing_texels = 1;
  int per_texel = 1;
};

class CavitiesMethod : public Method {
 public:
  std::string name() const override { return "cavities"; }
  std::string summary() const override {
    return "V-shaped cavities with multiple scattering, a BRDF [Che19]";
  }
  MethodTraits traits() const override {
    MethodTraits traits;
    traits.brdf = traits.lit_by_brdf = traits.brdf_references = true;
    traits.densities = traits.compared = false;
    return traits;
  }
  bool takes(Interpolation interpolation) const override { return interpolation != Interpolation::bicubic; }
  std::unique_ptr<MethodSettings> settings() const override {
    return std::make_unique<CavityMethodSettings>();
  }

  std::vector<double> brdf_references(const std::vector<BrdfQuery>& queries, const Surface& surface,
                                      const MethodSettings& settings) const override {
    return reference::CavityMixture(surface, settings_as<CavityMethodSettings>(settings).per_texel)
        .single(queries);
  }

  StructureSize structure(const StructureAsked& asked, const MethodSettings& settings) const override {
    const auto& own = settings_as<CavityMethodSettings>(settings);
    StructureSize size;
    size.device_bytes = map_structure_bytes(asked.width, asked.height);
    size.kernel = fmt::format("cavities/cavities.cl -DMICA_INTERPOLATION={} -DMICA_SEEDS={}",
                              static_cast<int>(asked.interpolation), own.per_texel);
    return size;
  }

  std::unique_ptr<PatchBrdf> make_own_brdf(Device* device, const Surface* surface,
                                           const MethodSettings& settings) const override {
    const auto& own = settings_as<CavityMethodSettings>(settings);
    CavitySettings cavities;
    cavities.compensation = own.compensation, cavities.compensation_width = own.compensation_width;
    cavities.energy = own.energy, cavities.per_texel = own.per_texel;
    return std::make_unique<CavityBrdf>(*device, *surface, cavities);
  }
};

}  // namespace

std::shared_ptr<const Method> cavities_method() {
  return std::make_shared<CavitiesMethod>();
}

}  // namespace mica::host
