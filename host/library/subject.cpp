#include "host/library/subject.h"

#include <fmt/format.h>

#include "host/device/device.h"
#include "host/surface/surface.h"
#include "mica/error.h"

namespace mica::host {

Subject::Subject(const mica::Device& device, std::shared_ptr<const Surface> surface, const std::string& name,
                 const Methods& methods)
    : device_(device.implementation()),
      surface_(std::move(surface)),
      methods_(methods.implementation()),
      method_(methods_->get(name)) {
  if (method_.traits().map != (surface_ != nullptr))
    throw UsageError(
        fmt::format("{} {}", name, surface_ ? "needs no map; found one" : "needs a map; found none"));
}

void Subject::refuse(std::size_t number, const std::string& problem) {
  if (!problem.empty()) throw UsageError(fmt::format("query {}: {}", number, problem));
}

void check_room(std::size_t expected, std::size_t found, bool is_null, const char* what) {
  if (found != expected || (is_null && expected > 0))
    throw UsageError(fmt::format("{}: found room for {}; expected {}", what, is_null ? 0 : found, expected));
}

void refuse_moved() {
  throw UsageError("found what was moved from; expected an evaluator, a BRDF or a renderer");
}

}  // namespace mica::host
