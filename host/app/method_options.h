#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/app/command_line.h"
#include "host/methods/registry.h"

namespace mica::host::app {

/// `--ndf NAME` with the settings of every method as options: an option that the chosen method does not know
/// is not read.
struct MethodOptions {
  const MethodRegistry* methods = nullptr;
  std::string name;
  std::vector<std::pair<std::string, std::string>> texts;  ///< by key; of what was given
  std::optional<double> tolerance;

  /// The text of a setting, or what it is where it was not given.
  std::string text(const std::string& key, const std::string& otherwise) const;
  bool given(const std::string& key) const;
};

/// Adds `--ndf`, of methods that `is_wanted`, and every setting of theirs.
void add_method_options(CommandLine* command, const MethodRegistry& methods,
                        const MethodRegistry::Wanted& is_wanted, MethodOptions* options);
/// Adds `--tolerance` as well.
void add_tolerance_option(CommandLine* command, MethodOptions* options);

const Method& method_of(const MethodOptions& options);
/// Throws UsageError for values out of range, and for a tolerance that the method cannot keep.
std::unique_ptr<MethodSettings> settings_of(const MethodOptions& options);

}  // namespace mica::host::app
