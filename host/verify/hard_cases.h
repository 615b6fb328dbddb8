#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "host/base/query.h"
#include "host/device/device.h"
#include "host/surface/surface.h"

namespace mica::host {

/// A kind of question that breaks evaluators.
struct HardCase {
  std::string name, why;
  std::function<Surface()> surface;  ///< may throw UsageError: then it is refused
  /// Footprint and roughness of the n-th question; n runs for ever, and every one is another.
  std::function<Query(const Surface&, std::uint64_t n)> question;
  bool own_half_vectors = false;  ///< the question's; otherwise those of `probe`
  bool must_be_refused = false;   ///< an answer would be a wrong one
  bool of_the_map = false;        ///< nothing that `grid`, which has no map, could stumble over
};

/// All of them.
const std::vector<HardCase>& hard_cases();

/// Half vectors to each question that is not refused outright.
std::vector<Query> probe_of(const HardCase& hard_case, const Surface& surface, std::uint64_t n,
                            int half_vectors);

}  // namespace mica::host
