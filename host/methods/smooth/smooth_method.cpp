#include "host/methods/beckmanns/slope_pyramid.h"
#include "host/methods/gaussians/mixture_settings.h"
#include "host/methods/method.h"
#include "host/methods/smooth/smooth_evaluator.h"

namespace mica::host {
namespace {

class SmoothMethod : public Method {
 public:
  std::string name() const override { return "smooth"; }
  std::string summary() const override {
    return "one Beckmann lobe a footprint, with the moments of its slopes: no glints, the baseline";
  }
  MethodTraits traits() const override {
    MethodTraits traits;
    traits.first_order = true;
    return traits;
  }
  bool takes(Interpolation interpolation) const override { return interpolation != Interpolation::bicubic; }
  std::unique_ptr<MethodSettings> settings() const override { return std::make_unique<ElementSettings>(); }

  StructureSize structure(const StructureAsked& asked, const MethodSettings& settings) const override {
    const int elements = settings_as<ElementSettings>(settings).elements;
    return {slope_pyramid_bytes(asked.width * elements, asked.height * elements, true), 0,
            "smooth/smooth.cl"};
  }

  std::unique_ptr<Evaluator> make_own(Device* device, const Surface* surface,
                                      const MethodSettings& settings) const override {
    MixtureSettings mixture;
    mixture.elements = settings_as<ElementSettings>(settings).elements;
    return std::make_unique<SmoothEvaluator>(*device, *surface, mixture);
  }
};

}  // namespace

std::shared_ptr<const Method> smooth_method() {
  return std::make_shared<SmoothMethod>();
}

}  // namespace mica::host
