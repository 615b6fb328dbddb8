#include "host/library/settings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>

#include "mica/error.h"

MICA_BEGIN_NAMESPACE

SettingValue::SettingValue(double value) : text_(fmt::format("{}", value)) {}

MICA_END_NAMESPACE

namespace mica::host {
namespace {

const std::string kTolerance = "tolerance";

std::optional<double> find_number(const Settings& settings, const std::string& key) {
  std::optional<double> number;
  for (const auto& [name, value] : settings) {
    if (name != key) continue;
    char* end = nullptr;
    number = std::strtod(value.text().c_str(), &end);
    if (value.text().empty() || *end != 0)
      throw UsageError(fmt::format("{}: found \"{}\"; expected a number", key, value.text()));
  }
  return number;
}

std::vector<std::string> known_keys(const Method& method) {
  std::vector<std::string> keys;
  for (const SettingEntry& entry : list_settings(*method.settings())) keys.push_back(entry.key);
  if (method.traits().keeps_tolerance) keys.push_back(kTolerance);
  return keys;
}

void check_keys(const Method& method, const Settings& settings) {
  const std::vector<std::string> known = known_keys(method);
  for (const auto& [key, value] : settings)
    if (std::find(known.begin(), known.end(), key) == known.end())
      throw UsageError(
          fmt::format("{}: found the setting \"{}\"; expected {}", method.name(), key,
                      known.empty() ? "none" : fmt::format("one of {}", fmt::join(known, ", "))));
}

}  // namespace

std::unique_ptr<MethodSettings> method_settings(const Method& method, const Settings& settings) {
  check_keys(method, settings);
  std::unique_ptr<MethodSettings> result = method.settings();
  SettingTexts texts;
  for (const auto& [key, value] : settings)
    if (key != kTolerance) texts.emplace_back(key, value.text());
  read_settings(texts, result.get());
  result->tolerance = find_number(settings, kTolerance);
  method.check(*result);
  return result;
}

}  // namespace mica::host
