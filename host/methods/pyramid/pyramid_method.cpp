#include "host/methods/map/map_structure.h"
#include "host/methods/method.h"
#include "host/methods/pyramid/pyramid_evaluator.h"
#include "host/methods/pyramid/pyramid_store.h"

namespace mica::host {
namespace {

class PyramidMethod : public Method {
 public:
  std::string name() const override { return "pyramid"; }
  std::string summary() const override {
    return "merged elements, whose number does not grow with the footprint";
  }
  MethodTraits traits() const override {
    MethodTraits traits;
    traits.first_order = true;
    return traits;
  }

  StructureSize structure(const StructureAsked& asked, const MethodSettings&) const override {
    return {map_structure_bytes(asked.width, asked.height) + pyramid_levels_bytes(asked.width, asked.height),
            0, "pyramid/pyramid.cl"};
  }

  std::unique_ptr<Evaluator> make_own(Device* device, const Surface* surface,
                                      const MethodSettings&) const override {
    return std::make_unique<PyramidEvaluator>(*device, *surface);
  }
};

}  // namespace

std::shared_ptr<const Method> pyramid_method() {
  return std::make_shared<PyramidMethod>();
}

}  // namespace mica::host
