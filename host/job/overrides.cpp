#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <memory>

#include "host/job/toml_document.h"

namespace mica::host {
namespace {

/// `key=value`, both without the blanks around them.
struct Assignment {
  std::string_view key, value;
};

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

/// Nothing when `text` is not one assignment on one line.
std::optional<Assignment> split(std::string_view text) {
  const bool one_line =
      std::none_of(text.begin(), text.end(), [](unsigned char c) { return c < 0x20 && c != '\t'; });
  std::size_t equals = 0;
  while (equals < text.size() && text[equals] != '=') {
    const bool is_quote = text[equals] == '"' || text[equals] == '\'';
    equals = is_quote ? skip_string(text, equals) : equals + 1;
  }
  if (!one_line || equals >= text.size()) return std::nullopt;
  const Assignment result{trimmed(text.substr(0, equals)), trimmed(text.substr(equals + 1))};
  const bool starts_key = !result.key.empty() && result.key[0] != '[' && result.key[0] != '#';
  return starts_key && !result.value.empty() ? std::optional(result) : std::nullopt;
}

/// A chain of tables with one key each, down to the value. A value that is not TOML is a string, unless it
/// starts like TOML's own strings, arrays and tables: there a mistake is more likely.
toml::table parse(const Assignment& assignment, const std::string& place) {
  try {
    return parse_toml(fmt::format("{} = {}", assignment.key, assignment.value), place);
  } catch (const toml::parse_error&) {
    const std::string_view value = assignment.value;
    const bool is_bare = value.find('\'') == std::string_view::npos &&
                         std::string_view("\"[{").find(value[0]) == std::string_view::npos;
    if (!is_bare) throw;
  }
  return parse_toml(fmt::format("{} = '{}'", assignment.key, assignment.value), place);
}

/// The element of `array` that `key` names, its end with an issue when there is none.
toml::array::iterator element(toml::array& array, const toml::key& key, Issues& issues) {
  const std::string_view digits = key.str();
  std::size_t index = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), index);
  const bool is_number = error == std::errc() && end == digits.data() + digits.size();
  if (is_number && index < array.size()) return array.begin() + std::ptrdiff_t(index);
  issues.add(key.source(),
             fmt::format("found {} as an index into an array of {}; expected an integer from 0 below {}",
                         in_quotes(digits), array.size(), array.size()));
  return array.end();
}

/// Moves the value at the end of the chain `patch` to its place under `target`.
void merge(toml::node& target, toml::table& patch, Issues& issues) {
  const toml::key& key = patch.begin()->first;
  toml::node& value = patch.begin()->second;
  toml::table* rest = value.as_table();
  if (rest && rest->is_inline()) rest = nullptr;  // { ... } is a value, to be replaced as a whole

  if (toml::table* table = target.as_table()) {
    toml::node* child = table->get(key.str());
    if (rest && child) return merge(*child, *rest, issues);
    table->insert_or_assign(key, std::move(value));
  } else if (toml::array* array = target.as_array()) {
    const auto child = element(*array, key, issues);
    if (child == array->end()) return;
    if (rest) return merge(*child, *rest, issues);
    array->replace(child, std::move(value));
  } else {
    issues.add(key.source(), fmt::format("found {} in front of {}; expected a table or an array",
                                         describe(target), in_quotes(key.str())));
  }
}

}  // namespace

void apply_override(toml::table& root, std::string_view text, Issues& issues) {
  const std::string place = "--set " + shortened(text);
  const std::optional<Assignment> assignment = split(text);
  if (!assignment) {
    issues.add({{}, {}, std::make_shared<const std::string>(place)},
               "found no assignment; expected key.path=value on one line");
    return;
  }
  try {
    toml::table patch = parse(*assignment, place);
    merge(root, patch, issues);
  } catch (const toml::parse_error& error) {
    issues.add(error.source(), printable(error.description()));
  }
}

}  // namespace mica::host
