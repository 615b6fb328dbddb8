#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "host/methods/method.h"

namespace mica::host {

/// The methods that there are, by name. A value: whoever wants more of them adds to a copy, and hands that
/// on.
class MethodRegistry {
 public:
  /// All methods of this library.
  static MethodRegistry builtin();

  /// Throws UsageError for a name that is taken.
  void add(std::shared_ptr<const Method> method);

  /// Null when there is none of that name.
  const Method* find(const std::string& name) const;
  /// Throws UsageError, which names those that there are.
  const Method& get(const std::string& name) const;
  /// As `get`, of methods that `is_wanted`: others do not exist for this caller.
  using Wanted = std::function<bool(const MethodTraits&)>;
  std::vector<std::string> names(const Wanted& is_wanted) const;

  const std::vector<std::shared_ptr<const Method>>& all() const { return methods_; }

 private:
  std::vector<std::shared_ptr<const Method>> methods_;
};

/// What calls make by name, with the settings that are given; of the library's own methods.
std::unique_ptr<Evaluator> make_evaluator(const std::string& name, Device& device, const Surface& surface,
                                          const SettingTexts& settings = {});
std::unique_ptr<PatchBrdf> make_patch_brdf(const std::string& name, Device& device, const Surface& surface,
                                           const SettingTexts& settings = {});

}  // namespace mica::host
