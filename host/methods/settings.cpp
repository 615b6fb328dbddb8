#include "host/methods/settings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "mica/error.h"

namespace mica::host {
namespace {

[[noreturn]] void refuse(const char* key, const std::string& found, const std::string& expected) {
  throw UsageError(fmt::format("{}: found {}; expected {}", key, found, expected));
}

double to_number(const char* key, const std::string& text, const SettingRange& range) {
  double value = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole_text = result.ec == std::errc() && result.ptr == text.data() + text.size();
  if (!whole_text || !(value >= range.low && value <= range.high) || (range.open_low && value == range.low))
    refuse(key, text,
           range.open_low ? fmt::format("a number above {}, at most {}", range.low, range.high)
                          : fmt::format("a number from {} to {}", range.low, range.high));
  return value;
}

/// Takes the values of texts.
class TextReader : public SettingVisitor {
 public:
  explicit TextReader(const SettingTexts& texts) : texts_(texts) {}
  SettingSource source() const override { return SettingSource::call; }

  void number(const char* key, const char*, double& value, const SettingRange& range) override {
    if (const std::string* text = find(key)) value = to_number(key, *text, range);
  }
  void whole(const char* key, const char*, int& value, int low, int high) override {
    const std::string* text = find(key);
    if (!text) return;
    const double number = to_number(key, *text, {static_cast<double>(low), static_cast<double>(high)});
    if (number != std::floor(number)) refuse(key, *text, "a whole number");
    value = static_cast<int>(number);
  }
  void seed(const char* key, const char*, std::uint32_t& value) override {
    const std::string* text = find(key);
    if (!text) return;
    const double number = to_number(key, *text, {0, 4294967295.0});
    if (number != std::floor(number)) refuse(key, *text, "a whole number below 2^32");
    value = static_cast<std::uint32_t>(number);
  }
  void one_or_two(const char* key, const char*, Eigen::Vector2d& value, const SettingRange& range) override {
    const std::string* text = find(key);
    if (!text) return;
    const std::size_t comma = text->find(',');
    value.x() = to_number(key, text->substr(0, comma), range);
    value.y() = comma == std::string::npos ? value.x() : to_number(key, text->substr(comma + 1), range);
  }
  void word(const char* key, const char*, int& chosen, const std::vector<std::string>& words) override {
    const std::string* text = find(key);
    if (!text) return;
    const auto found = std::find(words.begin(), words.end(), *text);
    if (found == words.end()) refuse(key, *text, fmt::format("{}", fmt::join(words, ", ")));
    chosen = static_cast<int>(found - words.begin());
  }

 private:
  /// The last one: later texts replace earlier ones.
  const std::string* find(const char* key) const {
    const auto found =
        std::find_if(texts_.rbegin(), texts_.rend(), [&](const auto& text) { return text.first == key; });
    return found == texts_.rend() ? nullptr : &found->second;
  }

  const SettingTexts& texts_;
};

/// Lists settings with their values.
class Lister : public SettingVisitor {
 public:
  SettingSource source() const override { return SettingSource::call; }
  void number(const char* key, const char* help, double& value, const SettingRange&) override {
    add(key, help, fmt::format("{}", value), "X");
  }
  void whole(const char* key, const char* help, int& value, int, int) override {
    add(key, help, fmt::format("{}", value), "N");
  }
  void seed(const char* key, const char* help, std::uint32_t& value) override {
    add(key, help, fmt::format("{}", value), "N");
  }
  void one_or_two(const char* key, const char* help, Eigen::Vector2d& value, const SettingRange&) override {
    add(key, help,
        value.x() == value.y() ? fmt::format("{}", value.x()) : fmt::format("{},{}", value.x(), value.y()),
        "X[,Y]");
  }
  void word(const char* key, const char* help, int& chosen, const std::vector<std::string>& words) override {
    add(key, help, words[static_cast<std::size_t>(chosen)], "NAME");
    entries.back().words = words;
  }
  void colors(const char* key, const char* help, std::vector<Eigen::Vector3d>& values, std::size_t) override {
    std::string text;
    for (const Eigen::Vector3d& c : values) text += fmt::format("[{},{},{}]", c.x(), c.y(), c.z());
    if (!text.empty()) add(key, help, text, "COLORS");
  }
  void file(const char* table, const char* key, const char* help, std::string& value) override {
    if (!value.empty()) add(fmt::format("{}.{}", table, key), help, value, "FILE");
  }

  std::vector<SettingEntry> entries;

 private:
  void add(const std::string& key, const char* help, const std::string& value, const char* type) {
    entries.push_back({key, help, value, type, {}});
  }
};

}  // namespace

std::vector<SettingEntry> list_settings(const MethodSettings& settings) {
  Lister lister;
  settings.clone()->visit(lister);
  return lister.entries;
}

std::string describe(const MethodSettings& settings) {
  std::vector<std::string> texts;
  for (const SettingEntry& entry : list_settings(settings)) texts.push_back(entry.key + " " + entry.value);
  return fmt::format("{}", fmt::join(texts, ", "));
}

void read_settings(const SettingTexts& texts, MethodSettings* settings) {
  TextReader reader(texts);
  settings->visit(reader);
  if (const MethodSettings::Problem problem = settings->problem(); !problem.message.empty())
    throw UsageError(fmt::format("{}: {}", problem.key, problem.message));
}

}  // namespace mica::host
