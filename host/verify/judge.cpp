#include "host/verify/judge.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/base/error_norms.h"
#include "host/verify/accuracy.h"

namespace mica::host {
namespace {

Verdict to_verdict(const Accuracy& accuracy) {
  const Query& q = accuracy.worst_query;
  return {accuracy.worst, accuracy.queries,
          fmt::format("D = {} instead of {} at uv ({}, {}), half vector ({}, {}), roughness {}",
                      accuracy.worst_density, accuracy.worst_reference, q.footprint.mean_uv.x(),
                      q.footprint.mean_uv.y(), q.half_vector.x(), q.half_vector.y(), q.roughness),
          ""};
}

/// An evaluator that promises to be near its own definition.
class StandardJudge : public Judge {
 public:
  StandardJudge(std::unique_ptr<Standard> standard, bool has_map)
      : standard_(std::move(standard)), has_map_(has_map) {}

  double highest(const Query& query) const override { return standard_->highest(query); }
  Verdict judge(Evaluator* evaluator, const Surface& surface,
                std::vector<std::vector<Query>> probes) const override {
    const std::vector<std::vector<Query>> asked = probes;
    const Accuracy accuracy = has_map_ ? compare(evaluator, *standard_, surface, std::move(probes))
                                       : compare_probes(evaluator, *standard_, probes);
    Verdict verdict = to_verdict(accuracy);
    verdict.limitation = standard_->limitation(asked, accuracy.worst_query, verdict.worst);
    return verdict;
  }

 private:
  std::unique_ptr<Standard> standard_;
  bool has_map_;
};

/// An evaluator that approximates the map, and promises nothing.
class ApproximationJudge : public Judge {
 public:
  explicit ApproximationJudge(const reference::Oracle& oracle) : oracle_(oracle) {}

  double highest(const Query&) const override { return std::numeric_limits<float>::max(); }
  Verdict judge(Evaluator* evaluator, const Surface&, std::vector<std::vector<Query>> probes) const override {
    constexpr double allowed = 0.01;
    Verdict verdict;
    RelativeL2 l2;
    for (const std::vector<Query>& probe : probes) {
      const std::vector<float> densities = evaluator->evaluate(probe);
      const std::vector<reference::OracleResult> references = oracle_.evaluate(probe);
      for (std::size_t n = 0; n < probe.size(); ++n) l2.add(densities[n], references[n].density);
      verdict.queries += probe.size();
    }
    const double error = l2.value();
    verdict.worst = error / allowed;
    verdict.limitation = fmt::format("approximates the map: relative L2 of {:.2g}% here", 100 * error);
    return verdict;
  }

 private:
  const reference::Oracle& oracle_;
};

/// A mixture: what it promises is to be its own sum, what it is asked for is the map.
class MixtureJudge : public Judge {
 public:
  MixtureJudge(std::unique_ptr<Judge> own, const reference::Oracle& oracle)
      : own_(std::move(own)), map_(oracle) {}

  double highest(const Query& query) const override { return own_->highest(query); }
  Verdict judge(Evaluator* evaluator, const Surface& surface,
                std::vector<std::vector<Query>> probes) const override {
    const Verdict own = own_->judge(evaluator, surface, probes);
    if (own.worst > 1) return own;
    Verdict map = map_.judge(evaluator, surface, std::move(probes));
    if (map.worst <= 1) return own;
    map.limitation += fmt::format("; is its own sum to {:.2g} of the bound", own.worst);
    return map;
  }

 private:
  std::unique_ptr<Judge> own_;
  ApproximationJudge map_;
};

}  // namespace

std::unique_ptr<Judge> make_judge(const Method& method, const MethodSettings& settings,
                                  const Surface& surface, const reference::Oracle& oracle) {
  std::unique_ptr<Standard> standard = method.standard(&surface, &oracle, settings);
  if (!standard) return std::make_unique<ApproximationJudge>(oracle);
  const bool has_map = method.traits().map, is_the_map = standard->is_the_map();
  auto own = std::make_unique<StandardJudge>(std::move(standard), has_map);
  if (!has_map || is_the_map) return own;
  return std::make_unique<MixtureJudge>(std::move(own), oracle);
}

}  // namespace mica::host
