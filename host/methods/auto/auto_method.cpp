#include <fmt/format.h>

#include "host/methods/auto/auto_evaluator.h"
#include "host/methods/map/map_structure.h"
#include "host/methods/method.h"
#include "host/methods/pyramid/pyramid_store.h"
#include "mica/error.h"

namespace mica::host {
namespace {

constexpr double kAutoTolerance = 0.01;  // relative L2 that it keeps unless it is told

class AutoMethod : public Method {
 public:
  std::string name() const override { return "auto"; }
  std::string summary() const override {
    return "the cheapest of these that keeps a tolerance, as a sample tells";
  }
  MethodTraits traits() const override {
    MethodTraits traits;
    traits.estimates_errors = traits.keeps_tolerance = traits.chooses = true;
    traits.compared = false;
    traits.first_order = true;
    return traits;
  }

  void check(const MethodSettings& settings) const override {
    if (settings.tolerance &&
        !(*settings.tolerance >= AutoEvaluator::kLeastTolerance && *settings.tolerance < 1))
      throw UsageError(fmt::format("tolerance {}: auto takes {} to 1; for less use triangles or reference",
                                   *settings.tolerance, AutoEvaluator::kLeastTolerance));
  }

  StructureSize structure(const StructureAsked& asked, const MethodSettings&) const override {
    return {map_structure_bytes(asked.width, asked.height) + pyramid_levels_bytes(asked.width, asked.height),
            0, "chosen from a sample of the job's queries"};  // bytes at most
  }

  std::unique_ptr<Evaluator> make_own(Device* device, const Surface* surface,
                                      const MethodSettings& settings) const override {
    return std::make_unique<AutoEvaluator>(*device, *surface, settings.tolerance.value_or(kAutoTolerance));
  }
};

}  // namespace

std::shared_ptr<const Method> auto_method() {
  return std::make_shared<AutoMethod>();
}

}  // namespace mica::host
