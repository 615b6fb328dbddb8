#include "host/app/method_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>

#include "mica/error.h"

namespace mica::host::app {
namespace {

/// A setting with all methods that have it.
struct Shared {
  SettingEntry entry;
  std::vector<std::string> methods;
};

std::vector<Shared> settings_of_all(const MethodRegistry& methods, const MethodRegistry::Wanted& is_wanted) {
  std::vector<Shared> all;
  for (const auto& method : methods.all()) {
    if (!is_wanted(method->traits())) continue;
    for (const SettingEntry& entry : list_settings(*method->settings())) {
      const auto found = std::find_if(all.begin(), all.end(),
                                      [&](const Shared& shared) { return shared.entry.key == entry.key; });
      if (found == all.end())
        all.push_back({entry, {method->name()}});
      else
        found->methods.push_back(method->name());
    }
  }
  return all;
}

}  // namespace

std::string MethodOptions::text(const std::string& key, const std::string& otherwise) const {
  for (const auto& [name, value] : texts)
    if (name == key) return value;
  return otherwise;
}

bool MethodOptions::given(const std::string& key) const {
  return std::any_of(texts.begin(), texts.end(), [&](const auto& text) { return text.first == key; });
}

void add_method_options(CommandLine* command, const MethodRegistry& methods,
                        const MethodRegistry::Wanted& is_wanted, MethodOptions* options) {
  options->methods = &methods;
  command->add_option("--ndf", options->name, "Method; reference is the host in double precision")
      .required()
      .type_name("NAME")
      .check(one_of(methods.names(is_wanted)));
  for (const Shared& shared : settings_of_all(methods, is_wanted)) {
    const std::string key = shared.entry.key;
    Option option = command->add_option(
        "--" + key, [options, key](const std::string& text) { options->texts.emplace_back(key, text); },
        fmt::format("{} [{}]", shared.entry.help, shared.entry.value));
    option.type_name(shared.entry.type).group(fmt::format("Settings of {}", fmt::join(shared.methods, ", ")));
    if (!shared.entry.words.empty()) option.check(one_of(shared.entry.words));
  }
}

void add_tolerance_option(CommandLine* command, MethodOptions* options) {
  command
      ->add_option("--tolerance", options->tolerance,
                   "Relative error allowed: auto and triangles keep it as relative L2 (default 0.01 and "
                   "1e-4), reference takes 1e-12 to 0.1")
      .type_name("ERROR");
}

const Method& method_of(const MethodOptions& options) {
  return options.methods->get(options.name);
}

std::unique_ptr<MethodSettings> settings_of(const MethodOptions& options) {
  const Method& method = method_of(options);
  std::unique_ptr<MethodSettings> settings = method.settings();
  SettingTexts texts;
  for (const auto& [key, text] : options.texts) texts.emplace_back(key, text);
  read_settings(texts, settings.get());
  settings->tolerance = options.tolerance;
  method.check(*settings);
  return settings;
}

}  // namespace mica::host::app
