#pragma once

#include <string>
#include <utility>

#include <fmt/format.h>

namespace mica::host::app {

/// To standard error, where a full or closed log must not end the work that it tells of.
void say_text(const std::string& text) noexcept;

template <typename... Values>
void say(fmt::format_string<Values...> format, Values&&... values) {
  say_text(fmt::format(format, std::forward<Values>(values)...));
}

/// A message for people: on several lines at most, each printable and of bearable length.
std::string presentable(const std::string& message);

}  // namespace mica::host::app
