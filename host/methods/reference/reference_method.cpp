#include <fmt/format.h>

#include <algorithm>

#include "host/base/stopwatch.h"
#include "host/methods/evaluator.h"
#include "host/methods/method.h"
#include "host/methods/patch_brdf.h"
#include "host/methods/ready_densities.h"
#include "host/methods/standard.h"
#include "host/reference/oracle.h"
#include "mica/error.h"

namespace mica::host {
namespace {

constexpr double kLeastTolerance = 1e-12, kLargestTolerance = 0.1;

/// The oracle behind the interface of the devices' evaluators.
class ReferenceEvaluator : public Evaluator {
 public:
  ReferenceEvaluator(const Surface& surface, double tolerance)
      : oracle_(surface, tolerance), tolerance_(tolerance) {
    build_seconds_ = watch_.seconds();
  }

  std::unique_ptr<PendingDensities> start(const std::vector<Query>& queries) override {
    const std::vector<reference::OracleResult> results = oracle_.evaluate(queries);
    std::vector<float> densities(results.size());
    std::transform(results.begin(), results.end(), densities.begin(),
                   [](const reference::OracleResult& result) { return static_cast<float>(result.density); });
    return std::make_unique<ReadyDensities>(std::move(densities));
  }
  double error_estimate(const Query&, double density) const override { return tolerance_ * density; }
  std::string name() const override { return "reference"; }
  std::size_t device_bytes() const override { return 0; }
  double build_seconds() const override { return build_seconds_; }
  double device_seconds() const override { return 0; }

 private:
  Stopwatch watch_;  // of the constructor
  reference::Oracle oracle_;
  double tolerance_, build_seconds_ = 0;
};

class ReferenceMethod : public Method {
 public:
  std::string name() const override { return "reference"; }
  std::string summary() const override { return "the oracle, on the host in double precision"; }
  MethodTraits traits() const override {
    MethodTraits traits;
    traits.device = traits.jobs = traits.compared = false;
    traits.keeps_tolerance = traits.estimates_errors = true;
    traits.first_order = true;
    return traits;
  }

  void check(const MethodSettings& settings) const override {
    if (settings.tolerance &&
        !(*settings.tolerance >= kLeastTolerance && *settings.tolerance <= kLargestTolerance))
      throw UsageError(fmt::format("tolerance {}: reference takes {} to {}", *settings.tolerance,
                                   kLeastTolerance, kLargestTolerance));
  }

  StructureSize structure(const StructureAsked&, const MethodSettings&) const override {
    return {0, 0, "none"};
  }

  std::unique_ptr<Evaluator> make_own(Device*, const Surface* surface,
                                      const MethodSettings& settings) const override {
    return std::make_unique<ReferenceEvaluator>(
        *surface, settings.tolerance.value_or(reference::Oracle::default_tolerance));
  }
};

}  // namespace

std::shared_ptr<const Method> reference_method() {
  return std::make_shared<ReferenceMethod>();
}

}  // namespace mica::host
