#include "host/methods/finite_brdf.h"

#include <atomic>
#include <cmath>

namespace mica::host {
namespace {

bool is_finite(const BrdfValue& value) {
  return std::isfinite(value.single) && std::isfinite(value.multiple) && std::isfinite(value.pdf);
}

bool is_finite(const Albedo& albedo) {
  return std::isfinite(albedo.single) && std::isfinite(albedo.lost);
}

bool is_finite(const BrdfSample& sample) {
  return sample.light.allFinite() && std::isfinite(sample.pdf) && std::isfinite(sample.weight_single) &&
         std::isfinite(sample.weight_multiple);
}

class FiniteBrdf : public PatchBrdf {
 public:
  explicit FiniteBrdf(std::unique_ptr<PatchBrdf> brdf) : brdf_(std::move(brdf)) {}

  std::vector<BrdfValue> evaluate(const std::vector<BrdfQuery>& queries) override {
    return repaired(brdf_->evaluate(queries));
  }
  std::vector<Albedo> energy(const std::vector<ViewQuery>& queries) override {
    return repaired(brdf_->energy(queries));
  }
  std::vector<BrdfSample> sample(const std::vector<SampleQuery>& queries) override {
    return repaired(brdf_->sample(queries));
  }

  std::size_t replaced() const override { return count_ + brdf_->replaced(); }
  std::string name() const override { return brdf_->name(); }
  std::size_t device_bytes() const override { return brdf_->device_bytes(); }
  double build_seconds() const override { return brdf_->build_seconds(); }
  double device_seconds() const override { return brdf_->device_seconds(); }

 private:
  template <typename Answer>
  std::vector<Answer> repaired(std::vector<Answer> answers) {
    for (Answer& answer : answers) {
      if (is_finite(answer)) continue;
      answer = Answer();
      ++count_;
    }
    return answers;
  }

  std::unique_ptr<PatchBrdf> brdf_;
  std::atomic<std::size_t> count_ = 0;
};

}  // namespace

std::unique_ptr<PatchBrdf> with_finite_answers(std::unique_ptr<PatchBrdf> brdf) {
  return std::make_unique<FiniteBrdf>(std::move(brdf));
}

}  // namespace mica::host
