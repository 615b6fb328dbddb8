#pragma once

#include <string>
#include <utility>
#include <vector>

#include "mica/version.h"

MICA_BEGIN_NAMESPACE

/// The value of a setting: a number, a truth, a word, or whatever text a job file would have there.
class MICA_API SettingValue {
 public:
  SettingValue(const char* text) : text_(text) {}                // NOLINT(google-explicit-constructor)
  SettingValue(std::string text) : text_(std::move(text)) {}     // NOLINT(google-explicit-constructor)
  SettingValue(int value) : text_(std::to_string(value)) {}      // NOLINT(google-explicit-constructor)
  SettingValue(bool value) : text_(value ? "true" : "false") {}  // NOLINT(google-explicit-constructor)
  SettingValue(double value);                                    // NOLINT(google-explicit-constructor)

  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

/// Settings by their keys, which are those of a job file: {{"elements", 2}, {"masking", "filtered"}}.
using Settings = std::vector<std::pair<std::string, SettingValue>>;

MICA_END_NAMESPACE
