#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "host/methods/registry.h"
#include "mica/device.h"
#include "mica/method.h"
#include "mica/settings.h"
#include "mica/span.h"

namespace mica::host {

/// What an evaluator or a BRDF of the library stands on, kept alive together: a device, a map or none, a
/// method.
class Subject {
 public:
  /// Throws UsageError for a name that is not there, and for a map where the method has none.
  Subject(const mica::Device& device, std::shared_ptr<const Surface> surface, const std::string& name,
          const Methods& methods);

  const Method& method() const { return method_; }
  Device* device() const { return device_.get(); }
  const Surface* surface() const { return surface_.get(); }

  /// Throws UsageError, which names the first of queries 0 .. count - 1 that cannot be answered.
  template <typename QueryOf>
  void check(std::size_t count, const QueryOf& query) const {
    for (std::size_t n = 0; n < count; ++n) refuse(n, method_.query_problem(query(n), surface()));
  }

 private:
  static void refuse(std::size_t number, const std::string& problem);

  std::shared_ptr<Device> device_;
  std::shared_ptr<const Surface> surface_;
  std::shared_ptr<const MethodRegistry> methods_;
  const Method& method_;
};

/// Throws UsageError unless there is memory for what will be written.
void check_room(std::size_t expected, std::size_t found, bool is_null, const char* what);
template <typename T>
void check_room(std::size_t expected, Span<T> room, const char* what) {
  check_room(expected, room.size, room.data == nullptr, what);
}

[[noreturn]] void refuse_moved();

/// What a handle of the library holds. Throws UsageError when it was moved from.
template <typename Implementation>
Implementation& opened(const std::shared_ptr<Implementation>& implementation) {
  if (!implementation) refuse_moved();
  return *implementation;
}

}  // namespace mica::host
