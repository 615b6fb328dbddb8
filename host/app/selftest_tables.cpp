#include "host/app/selftest_tables.h"

#include "host/app/say.h"

#include <fmt/format.h>

#include <algorithm>

#include "host/base/interrupt.h"
#include "host/verify/hard_directions.h"

namespace mica::host::app {
namespace {

std::string ulp_text(double ulp) {
  return ulp > 0 ? fmt::format("{:g}", ulp) : "-";
}

void print(const HardResult& result) {
  fmt::print("{:<36} {:<20} {:<13} {:>9} {:>8} {:>8}  {}\n", result.hard_case, result.evaluator,
             name_of(result.outcome), result.evaluated, result.compared,
             result.compared ? fmt::format("{:.3f}", result.worst) : "-", result.reason);
}

/// Adds another run of the same case and evaluator; the worse outcome stays.
void add(const HardResult& more, HardResult* sum) {
  sum->evaluated += more.evaluated, sum->compared += more.compared;
  if (more.worst > sum->worst || more.outcome > sum->outcome) {
    sum->worst = std::max(sum->worst, more.worst);
    if (more.outcome >= sum->outcome) sum->outcome = more.outcome, sum->reason = more.reason;
  }
}

std::uint64_t evaluated(const std::vector<HardResult>& results) {
  std::uint64_t sum = 0;
  for (const HardResult& result : results) sum += result.evaluated;
  return sum;
}

/// Rounds of further questions to every case and evaluator.
void ask_more(Device* device, std::uint64_t evaluations, const MethodRegistry& methods,
              std::vector<HardResult>* results) {
  HardEffort effort;
  effort.footprints = 1;
  effort.evaluations = std::clamp<std::uint64_t>(evaluations / 400, 1000, 250'000);
  for (std::uint64_t round = 1; evaluated(*results) < evaluations; ++round) {
    effort.first = round * 1'000'000;
    for (const HardCase& hard_case : hard_cases()) {
      check_interrupt();
      for (const HardResult& more : run_hard_case(hard_case, *device, effort, methods)) {
        const auto same = std::find_if(results->begin(), results->end(), [&](const HardResult& r) {
          return r.hard_case == more.hard_case && r.evaluator == more.evaluator;
        });
        add(more, &*same);
      }
    }
    say("{:.3g} of {:.3g} evaluations\n", static_cast<double>(evaluated(*results)),
        static_cast<double>(evaluations));
  }
}

}  // namespace

void print_arithmetic(const std::vector<FunctionError>& errors) {
  fmt::print("\n{:<18} {:<42} {:>8} {:>10} {:>14} {:>12} {:>12}\n", "function", "range", "points",
             "worst ULP", "at", "OpenCL 1.2", "Mica needs");
  for (const FunctionError& e : errors)
    fmt::print("{:<18} {:<42} {:>8} {:>10.3f} {:>14.6g} {:>12} {:>12}\n", e.function, e.range, e.points,
               e.worst_ulp, e.worst_at, ulp_text(e.opencl_ulp), ulp_text(e.needed_ulp));
  const bool enough = std::all_of(errors.begin(), errors.end(), [](const FunctionError& e) {
    return e.needed_ulp == 0 || e.worst_ulp <= e.needed_ulp;
  });
  fmt::print("This device's arithmetic is {}good enough for the errors that Mica promises.\n\n",
             enough ? "" : "NOT ");
}

nlohmann::json arithmetic_json(const std::vector<FunctionError>& errors) {
  nlohmann::json list = nlohmann::json::array();
  for (const FunctionError& e : errors)
    list.push_back(
        {{"function", e.function},
         {"range", e.range},
         {"points", e.points},
         {"worst_ulp", std::isfinite(e.worst_ulp) ? nlohmann::json(e.worst_ulp) : nlohmann::json()},
         {"worst_at", e.worst_at},
         {"opencl_ulp", e.opencl_ulp},
         {"needed_ulp", e.needed_ulp}});
  return list;
}

std::vector<HardResult> print_hard_cases(Device* device, std::uint64_t evaluations,
                                         const MethodRegistry& methods) {
  std::vector<HardResult> results;
  for (const HardCase& hard_case : hard_cases()) {
    check_interrupt();
    for (const HardResult& result : run_hard_case(hard_case, *device, {}, methods)) results.push_back(result);
  }
  if (evaluations > 0) ask_more(device, evaluations, methods, &results);
  constexpr int queries = 100;
  for (const HardDirections& directions : hard_directions())
    for (const HardResult& result : run_hard_directions(directions, *device, queries, methods))
      results.push_back(result);
  fmt::print("\n{:<36} {:<20} {:<13} {:>9} {:>8} {:>8}\n", "hard case", "evaluator", "outcome", "answers",
             "compared", "error");
  for (const HardResult& result : results) print(result);
  fmt::print("{} answers were looked at: finite, not negative, and not above what can be.\n\n",
             evaluated(results));
  return results;
}

nlohmann::json hard_cases_json(const std::vector<HardResult>& results) {
  nlohmann::json list = nlohmann::json::array();
  for (const HardResult& r : results)
    list.push_back({{"case", r.hard_case},
                    {"evaluator", r.evaluator},
                    {"outcome", name_of(r.outcome)},
                    {"error_of_bound", r.worst},
                    {"answers", r.evaluated},
                    {"compared", r.compared},
                    {"reason", r.reason}});
  return list;
}

std::vector<HardAnswers> print_hard_answers(Device* device, std::uint64_t answers,
                                            const MethodRegistry& methods) {
  if (answers == 0) return {};
  const std::vector<HardAnswers> all = ask_hard_questions(*device, answers, 0, methods);
  fmt::print("{:<20} {:>10} {:>9} {:>8} {:>6}  {}\n", "random questions", "answered", "replaced", "refused",
             "wrong", "the first wrong one");
  for (const HardAnswers& a : all)
    fmt::print("{:<20} {:>10} {:>9} {:>8} {:>6}  {}\n", a.method, a.answered, a.replaced, a.refused, a.wrong,
               a.fault);
  return all;
}

nlohmann::json hard_answers_json(const std::vector<HardAnswers>& answers) {
  nlohmann::json list = nlohmann::json::array();
  for (const HardAnswers& a : answers)
    list.push_back({{"method", a.method},
                    {"answered", a.answered},
                    {"replaced", a.replaced},
                    {"refused", a.refused},
                    {"wrong", a.wrong},
                    {"fault", a.fault}});
  return list;
}

}  // namespace mica::host::app
