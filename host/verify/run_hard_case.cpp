#include "host/verify/run_hard_case.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "host/methods/map/map_query.h"
#include "host/verify/accuracy.h"
#include "host/verify/judge.h"
#include "mica/error.h"

namespace mica::host {
namespace {

constexpr int kHalfVectors = 8;

using Problem = std::function<std::string(const Query&)>;

/// Probes whose queries can all be evaluated; the first reason why others cannot.
struct Questions {
  std::vector<std::vector<Query>> probes;
  std::string problem;
};
Questions ask(const HardCase& hard_case, const Surface& surface, std::uint64_t first,
              std::uint64_t footprints, int half_vectors, const Problem& problem_of) {
  std::vector<std::vector<Query>> probes(footprints);
  tbb::parallel_for(std::uint64_t{0}, footprints, [&](std::uint64_t n) {
    probes[n] = probe_of(hard_case, surface, first + n, half_vectors);
  });
  Questions questions;
  for (std::vector<Query>& probe : probes) {
    const auto bad =
        std::find_if(probe.begin(), probe.end(), [&](const Query& q) { return !problem_of(q).empty(); });
    if (bad == probe.end())
      questions.probes.push_back(std::move(probe));
    else if (questions.problem.empty())
      questions.problem = problem_of(*bad);
  }
  return questions;
}

/// Looks at an answer: what is wrong with it, or empty.
std::string fault_of(const Query& query, float density, double highest) {
  if (std::isfinite(density) && density >= 0 && density <= highest) return "";
  return fmt::format("D = {} (allowed: 0 to {:.6g}) at uv ({}, {}), half vector ({}, {}), roughness {}",
                     density, highest, query.footprint.mean_uv.x(), query.footprint.mean_uv.y(),
                     query.half_vector.x(), query.half_vector.y(), query.roughness);
}

/// Footprints are dear by their area, and by the number of half vectors that see them.
std::uint64_t affordable_queries(const HardCase& hard_case, const Surface& surface,
                                 std::uint64_t evaluations) {
  const Footprint footprint = hard_case.question(surface, 1).footprint;
  const double texels2 = 1.0 * surface.width() * surface.height();
  const double area = std::sqrt(std::max(footprint.cov_uv.determinant(), 0.0)) * texels2;
  const double share = 1 / (1 + 0.2 * std::min(area, 0.64 * texels2));
  return std::max<std::uint64_t>(static_cast<std::uint64_t>(share * static_cast<double>(evaluations)), 256);
}

/// One evaluator on one case.
class Trial {
 public:
  Trial(const HardCase& hard_case, const Surface& surface, const HardEffort& effort, Problem problem)
      : hard_case_(hard_case), surface_(surface), effort_(effort), problem_(std::move(problem)) {}

  HardResult run(Evaluator* evaluator, const Judge& judge) {
    result_.hard_case = hard_case_.name, result_.evaluator = evaluator->name();
    Questions questions = ask(hard_case_, surface_, effort_.first,
                              static_cast<std::uint64_t>(effort_.footprints), kHalfVectors, problem_);
    if (questions.probes.empty()) {
      result_.outcome = Outcome::refused, result_.reason = questions.problem;
      return result_;
    }
    if (hard_case_.must_be_refused) return broken("was answered, but has no answer");
    try {
      look_at_many(evaluator, judge);
      if (result_.outcome != Outcome::broken) judge_some(evaluator, judge, std::move(questions.probes));
    } catch (const DeviceError& error) {
      return broken(error.what());  // evaluators throw it for answers that are no densities
    }
    return result_;
  }

 private:
  HardResult broken(const std::string& reason) {
    result_.outcome = Outcome::broken, result_.reason = reason;
    return result_;
  }

  void look_at_many(Evaluator* evaluator, const Judge& judge) {
    constexpr std::uint64_t batch = 1 << 16;
    const std::uint64_t all =
        effort_.evaluations ? affordable_queries(hard_case_, surface_, effort_.evaluations) : 0;
    for (std::uint64_t done = 0; done < all && result_.outcome != Outcome::broken; done += batch) {
      const std::uint64_t footprints = std::min(batch, all - done) / 64 + 1;
      const std::uint64_t first = effort_.first + 1000 + done / 64;
      std::vector<Query> queries;
      for (const std::vector<Query>& probe :
           ask(hard_case_, surface_, first, footprints, 64, problem_).probes)
        queries.insert(queries.end(), probe.begin(), probe.end());
      look_at(queries, evaluator->evaluate(queries), judge);
    }
  }

  void look_at(const std::vector<Query>& queries, const std::vector<float>& densities, const Judge& judge) {
    result_.evaluated += queries.size();
    for (std::size_t n = 0; n < queries.size(); ++n) {
      const std::string fault = fault_of(queries[n], densities[n], judge.highest(queries[n]));
      if (fault.empty()) continue;
      broken(fault);
      return;
    }
  }

  void judge_some(Evaluator* evaluator, const Judge& judge, std::vector<std::vector<Query>> probes) {
    std::vector<Query> queries;
    for (const std::vector<Query>& probe : probes) queries.insert(queries.end(), probe.begin(), probe.end());
    look_at(queries, evaluator->evaluate(queries), judge);
    if (result_.outcome == Outcome::broken) return;
    const Verdict verdict = judge.judge(evaluator, surface_, std::move(probes));
    result_.worst = verdict.worst, result_.compared = verdict.queries;
    if (verdict.worst <= 1) return;
    result_.outcome = verdict.limitation.empty() ? Outcome::broken : Outcome::limitation;
    result_.reason = verdict.limitation.empty() ? verdict.worst_query : verdict.limitation;
  }

  const HardCase& hard_case_;
  const Surface& surface_;
  HardEffort effort_;
  Problem problem_;
  HardResult result_;
};

HardResult refused(const HardCase& hard_case, const std::string& evaluator, const std::string& reason) {
  HardResult result;
  result.hard_case = hard_case.name, result.evaluator = evaluator;
  result.outcome = Outcome::refused, result.reason = reason;
  return result;
}

HardResult run_method(const HardCase& hard_case, const Method& method, const Surface& surface,
                      const reference::Oracle& oracle, Device& device, const HardEffort& effort) {
  try {
    const bool has_map = method.traits().map;
    const std::unique_ptr<MethodSettings> settings =
        has_map ? method.settings() : method.settings_beside(surface.width(), surface.height());
    const std::unique_ptr<Evaluator> evaluator = method.make(&device, &surface, *settings);
    const Problem problem = [&](const Query& q) { return method.query_problem(q, &surface); };
    return Trial(hard_case, surface, effort, problem)
        .run(evaluator.get(), *make_judge(method, *settings, surface, oracle));
  } catch (const UsageError& error) {
    return refused(hard_case, method.name(), error.what());
  }
}

}  // namespace

const char* name_of(Outcome outcome) {
  switch (outcome) {
    case Outcome::within_bound:
      return "within bound";
    case Outcome::refused:
      return "refused";
    case Outcome::limitation:
      return "limitation";
    case Outcome::broken:
      return "BROKEN";
  }
  return "";
}

std::vector<HardResult> run_hard_case(const HardCase& hard_case, Device& device, const HardEffort& effort,
                                      const MethodRegistry& methods) {
  std::vector<HardResult> results;
  std::optional<Surface> surface;
  std::string problem;
  try {
    surface = hard_case.surface();
  } catch (const UsageError& error) {
    problem = error.what();
  }
  constexpr double oracle_tolerance = 1e-7;
  std::optional<reference::Oracle> oracle;
  if (surface) oracle.emplace(*surface, oracle_tolerance);
  for (const auto& method : methods.all()) {
    const MethodTraits traits = method->traits();
    if (!traits.compared || (!traits.map && (hard_case.of_the_map || !surface))) continue;
    results.push_back(surface ? run_method(hard_case, *method, *surface, *oracle, device, effort)
                              : refused(hard_case, method->name(), problem));
  }
  return results;
}

HardResult run_trial(const HardCase& hard_case, const Surface& surface, Evaluator* evaluator,
                     const Judge& judge, const HardEffort& effort) {
  const Problem problem = [&](const Query& q) { return query_problem(q, surface.width(), surface.height()); };
  return Trial(hard_case, surface, effort, problem).run(evaluator, judge);
}

}  // namespace mica::host
