#include "host/job/toml_document.h"

#include <fmt/format.h>

#include <memory>

namespace mica::host {

toml::table parse_toml(std::string_view text, const std::string& source_path) {
  constexpr int deepest = 16;
  if (const auto place = find_excessive_nesting(text, deepest)) {
    const std::string message =
        fmt::format("found more than {0} nested levels; expected at most {0}", deepest);
    throw toml::parse_error(message.c_str(), *place, std::make_shared<const std::string>(source_path));
  }
  return toml::parse(text, source_path);
}

std::string describe(const toml::node& node) {
  if (const auto* text = node.as_string()) return in_quotes(text->get()) + " (a string)";
  if (const auto* integer = node.as_integer()) return fmt::format("{}", integer->get());
  if (const auto* number = node.as_floating_point()) return fmt::format("{} (a float)", number->get());
  if (const auto* flag = node.as_boolean()) return flag->get() ? "true" : "false";
  if (node.is_array()) return "an array";
  return node.is_table() ? "a table" : "a date or time";
}

}  // namespace mica::host
