#include <fmt/format.h>

#include <algorithm>

#include "host/methods/gaussians/mixture.h"
#include "host/methods/gaussians/mixture_evaluator.h"
#include "host/methods/gaussians/mixture_settings.h"
#include "host/methods/method.h"
#include "host/reference/gaussian_mixture.h"

namespace mica::host {
namespace {

constexpr double kFlopsAnElement = 105;  // of slice_elements in gaussians.cl and its share of the leaf

/// The mixture's own sum, in double precision.
class MixtureStandard : public Standard {
 public:
  MixtureStandard(const Surface& surface, int elements) : mixture_(surface, elements) {}

  std::vector<double> references(const std::vector<Query>& queries) const override {
    std::vector<Query> near(queries.size());
    std::transform(queries.begin(), queries.end(), near.begin(), without_far_periods);
    return mixture_.evaluate(near);
  }
  Promise promise(double) const override { return {1e-4, kMixtureDrops}; }
  double highest(const Query& query) const override { return (1 + 2e-3) * lobe_peak(query); }

 private:
  reference::GaussianMixture mixture_;
};

MixtureSettings mixture_of(const MethodSettings& settings) {
  MixtureSettings mixture;
  mixture.elements = settings_as<ElementSettings>(settings).elements;
  return mixture;
}

class GaussiansMethod : public Method {
 public:
  std::string name() const override { return "gaussians"; }
  std::string summary() const override { return "a mixture of 4D Gaussians of position and normal [Yan16]"; }
  MethodTraits traits() const override {
    MethodTraits traits;
    traits.first_order = true;
    return traits;
  }
  bool takes(Interpolation interpolation) const override { return interpolation != Interpolation::bicubic; }
  std::unique_ptr<MethodSettings> settings() const override { return std::make_unique<ElementSettings>(); }

  StructureSize structure(const StructureAsked& asked, const MethodSettings&) const override {
    return {
        gaussian_mixture_bytes(asked.width, asked.height), 0,
        fmt::format("gaussians/gaussians.cl -DMICA_INTERPOLATION={}", static_cast<int>(asked.interpolation))};
  }

  std::unique_ptr<Evaluator> make_own(Device* device, const Surface* surface,
                                      const MethodSettings& settings) const override {
    return std::make_unique<GaussianEvaluator>(*device, *surface, mixture_of(settings));
  }

  std::unique_ptr<Standard> standard(const Surface* surface, const reference::Oracle*,
                                     const MethodSettings& settings) const override {
    return std::make_unique<MixtureStandard>(*surface, settings_as<ElementSettings>(settings).elements);
  }

  std::vector<MethodVariant> variants(const std::vector<int>& elements) const override {
    return element_variants<ElementSettings>(name(), elements);
  }

  OperationCounter counter(Device* device, const Surface* surface,
                           const MethodSettings& settings) const override {
    MixtureSettings mixture = mixture_of(settings);
    mixture.count_elements = true;
    return {std::make_unique<GaussianEvaluator>(*device, *surface, mixture), kFlopsAnElement};
  }
};

}  // namespace

std::shared_ptr<const Method> gaussians_method() {
  return std::make_shared<GaussiansMethod>();
}

}  // namespace mica::host
