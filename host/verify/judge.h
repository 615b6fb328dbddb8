#pragma once

#include <memory>
#include <string>
#include <vector>

#include "host/methods/evaluator.h"
#include "host/methods/method.h"
#include "host/methods/standard.h"
#include "host/reference/oracle.h"
#include "host/surface/surface.h"

namespace mica::host {

/// How an evaluator did against its reference in double precision.
struct Verdict {
  double worst = 0;  ///< largest error, in units of what is allowed
  std::size_t queries = 0;
  std::string worst_query;  ///< and what was answered to it
  std::string limitation;   ///< why more than what is allowed is no mistake, or empty
};

/// Knows what an evaluator promises, and the reference that it is promised against.
class Judge {
 public:
  virtual ~Judge() = default;

  /// Highest density that can be right.
  virtual double highest(const Query& query) const = 0;
  /// @param probes each of one footprint.
  virtual Verdict judge(Evaluator* evaluator, const Surface& surface,
                        std::vector<std::vector<Query>> probes) const = 0;
};

/// For a method with these settings. The surface and the oracle have to outlive it.
std::unique_ptr<Judge> make_judge(const Method& method, const MethodSettings& settings,
                                  const Surface& surface, const reference::Oracle& oracle);

}  // namespace mica::host
