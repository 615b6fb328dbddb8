#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host/methods/registry.h"
#include "host/verify/hard_cases.h"
#include "host/verify/judge.h"

namespace mica::host {

/// What an evaluator may do with a hard case, and what it may not.
enum class Outcome {
  within_bound,  ///< keeps what it promises
  refused,       ///< with a reason
  limitation,    ///< answers, but not to a bound; the reason says which limitation, and how far off it is
  broken         ///< NaN, infinite, negative or wrong answers, or an answer where none can be right
};
const char* name_of(Outcome outcome);

struct HardResult {
  std::string hard_case, evaluator;
  Outcome outcome = Outcome::within_bound;
  double worst = 0;             ///< error of those that were compared, in units of what is allowed
  std::uint64_t evaluated = 0;  ///< answers that were looked at, each of them
  std::uint64_t compared = 0;   ///< those of them that were set against a reference in double precision
  std::string reason;           ///< why; empty where the bound was kept
};

/// How many questions of a case are asked. Costly ones are asked less often.
struct HardEffort {
  int footprints = 4;             ///< that are compared with the reference, nine half vectors each
  std::uint64_t evaluations = 0;  ///< more answers that are looked at, at a footprint of a texel
  std::uint64_t first = 0;        ///< number of the first question
};

/// Asks every method of the registry that is compared, with its default settings.
///
/// A method is set against its Standard: `triangles` against the oracle, `grid` against [Kem25] Algorithm 1.
/// Others approximate the map: further from the oracle than a relative L2 of one percent is their documented
/// limitation; mixtures also have to be their own sum in double precision. All answers have to be finite, not
/// negative, and not above what can be.
std::vector<HardResult> run_hard_case(const HardCase& hard_case, Device& device, const HardEffort& effort,
                                      const MethodRegistry& methods = MethodRegistry::builtin());

/// Runs a case for one evaluator on the case's surface.
HardResult run_trial(const HardCase& hard_case, const Surface& surface, Evaluator* evaluator,
                     const Judge& judge, const HardEffort& effort);

}  // namespace mica::host
