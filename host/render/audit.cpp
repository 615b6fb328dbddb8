#include "host/render/audit.h"

#include <algorithm>
#include <cmath>

#include "host/base/error_norms.h"
#include "host/base/random.h"
#include "host/reference/glint_grid.h"
#include "host/reference/oracle.h"

namespace mica::host {
namespace {

constexpr double kOracleTolerance = 1e-7;  // a thousandth of what is promised

bool lower_key(const AuditSample& a, const AuditSample& b) {
  return a.key < b.key;
}

double density_of(const BrdfQuery& query, double single) {
  return 4 * query.view.z() * single;
}

/// Of those whose BRDF was asked, by the evaluators' own definitions.
void add_brdf_references(const std::vector<AuditSample>& samples, std::size_t evaluators,
                         const BrdfReferences& brdf_references, std::vector<double>* references) {
  for (std::size_t evaluator = 0; evaluator < evaluators; ++evaluator) {
    std::vector<std::size_t> places;
    std::vector<BrdfQuery> queries;
    for (std::size_t n = 0; n < samples.size(); ++n)
      if (samples[n].brdf && samples[n].evaluator == static_cast<int>(evaluator))
        places.push_back(n), queries.push_back(*samples[n].brdf);
    if (queries.empty()) continue;
    const std::vector<double> answers = brdf_references(evaluator, queries);
    for (std::size_t n = 0; n < places.size(); ++n)
      (*references)[places[n]] = density_of(queries[n], answers[n]);
  }
}

}  // namespace

void AuditSampler::offer(std::uint64_t pixel, std::uint64_t ordinal, const Query& query, float density,
                         int evaluator, const GlintPoint& glints) {
  offer(pixel, ordinal, {0, query, density, evaluator, glints, {}});
}

void AuditSampler::offer_brdf(std::uint64_t pixel, std::uint64_t ordinal, const BrdfQuery& query,
                              float single, int evaluator) {
  const auto density = static_cast<float>(density_of(query, single));
  offer(pixel, ordinal, {0, {}, density, evaluator, {}, query});
}

void AuditSampler::offer(std::uint64_t pixel, std::uint64_t ordinal, AuditSample sample) {
  if (samples_ == 0) return;
  const std::uint64_t key = scramble_bits(scramble_bits(mix_bits(seed_) ^ pixel) ^ ordinal);
  if (heap_.size() == samples_) {
    if (key >= heap_.front().key) return;
    std::pop_heap(heap_.begin(), heap_.end(), lower_key);
    heap_.pop_back();
  }
  sample.key = key;
  heap_.push_back(std::move(sample));
  std::push_heap(heap_.begin(), heap_.end(), lower_key);
}

std::vector<AuditSample> AuditSampler::samples() const {
  std::vector<AuditSample> sorted = heap_;
  std::sort(sorted.begin(), sorted.end(), lower_key);
  return sorted;
}

std::vector<AuditedSample> audit(const std::vector<AuditSample>& samples,
                                 const std::vector<const Surface*>& surfaces,
                                 const BrdfReferences& brdf_references) {
  std::vector<double> reference(samples.size());
  for (std::size_t n = 0; n < samples.size(); ++n)
    if (!samples[n].brdf && !surfaces[static_cast<std::size_t>(samples[n].evaluator)])
      reference[n] = reference::GlintProcess(samples[n].glints).density_of(samples[n].query);
  for (std::size_t surface = 0; surface < surfaces.size(); ++surface) {
    if (!surfaces[surface]) continue;
    std::vector<std::size_t> places;
    std::vector<Query> queries;
    for (std::size_t n = 0; n < samples.size(); ++n) {
      if (samples[n].brdf || samples[n].evaluator != static_cast<int>(surface)) continue;
      places.push_back(n);
      queries.push_back(with_wider_lobe(samples[n].query, surfaces[surface]->lobe_variance()));
    }
    if (queries.empty()) continue;
    const std::vector<reference::OracleResult> answers =
        reference::Oracle(*surfaces[surface], kOracleTolerance).evaluate(queries);
    for (std::size_t n = 0; n < places.size(); ++n) reference[places[n]] = answers[n].density;
  }
  add_brdf_references(samples, surfaces.size(), brdf_references, &reference);
  std::vector<AuditedSample> audited;
  for (std::size_t n = 0; n < samples.size(); ++n)
    audited.push_back({samples[n].key, samples[n].density, reference[n]});
  return audited;
}

AuditResult audit_result(const std::vector<AuditedSample>& samples) {
  AuditResult result;
  result.samples = samples.size();
  if (samples.empty()) return result;
  double peak = 0;
  for (const AuditedSample& sample : samples) peak = std::max(peak, sample.reference);
  RelativeL2 l2;
  std::vector<double> errors;
  for (const AuditedSample& sample : samples) {
    const double difference = std::abs(sample.density - sample.reference);
    l2.add(sample.density, sample.reference);
    errors.push_back(difference == 0 ? 0 : difference / (sample.reference + 0.01 * peak));
  }
  std::sort(errors.begin(), errors.end());
  result.relative_l2 = l2.has_reference() ? l2.value() : 0;
  result.percentile_99 = errors[static_cast<std::size_t>(0.99 * static_cast<double>(errors.size() - 1))];
  result.maximum = errors.back();
  return result;
}

}  // namespace mica::host
