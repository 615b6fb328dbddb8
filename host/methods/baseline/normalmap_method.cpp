#include "host/methods/baseline/normal_map_brdf.h"
#include "host/methods/method.h"

namespace mica::host {
namespace {

class NormalMapMethod : public Method {
 public:
  std::string name() const override { return "normalmap"; }
  std::string summary() const override {
    return "classic normal mapping, one normal a footprint: a baseline";
  }
  MethodTraits traits() const override {
    MethodTraits traits;
    traits.brdf = traits.lit_by_brdf = true;
    traits.densities = traits.device = traits.compared = false;
    return traits;
  }

  StructureSize structure(const StructureAsked& asked, const MethodSettings&) const override {
    // It keeps the map, and needs no device.
    return {0, sizeof(Eigen::Vector2d) * asked.width * asked.height, "none"};
  }

  std::unique_ptr<PatchBrdf> make_own_brdf(Device*, const Surface* surface,
                                           const MethodSettings&) const override {
    return std::make_unique<NormalMapBrdf>(*surface);
  }
};

}  // namespace

std::shared_ptr<const Method> normalmap_method() {
  return std::make_shared<NormalMapMethod>();
}

}  // namespace mica::host
