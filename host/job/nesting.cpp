#include <algorithm>

#include "host/job/toml_document.h"

namespace mica::host {
namespace {

/// Counted as toml++ does: from 1, columns in code points.
toml::source_position position_of(std::string_view text, std::size_t offset) {
  toml::source_position position{1, 1};
  for (const char c : text.substr(0, offset)) {
    if (c == '\n') {
      ++position.line;
      position.column = 1;
    } else if ((c & 0xc0) != 0x80) {
      ++position.column;
    }
  }
  return position;
}

std::size_t skip_long_string(std::string_view text, std::size_t begin) {
  const std::string_view delimiter = text.substr(begin, 3);
  const bool escapes = delimiter[0] == '"';
  for (std::size_t i = begin + 3; i < text.size(); ++i) {
    if (escapes && text[i] == '\\') {
      ++i;
    } else if (text.substr(i, 3) == delimiter) {
      i += 3;
      for (int extra = 0; extra < 2 && i < text.size() && text[i] == delimiter[0]; ++extra) ++i;
      return i;
    }
  }
  return text.size();
}

}  // namespace

std::size_t skip_string(std::string_view text, std::size_t begin) {
  const char quote = text[begin];
  if (text.substr(begin, 3) == std::string_view(quote == '"' ? R"(""")" : "'''")) {
    return skip_long_string(text, begin);
  }
  for (std::size_t i = begin + 1; i < text.size(); ++i) {
    if (text[i] == quote || text[i] == '\n') return i + 1;
    if (quote == '"' && text[i] == '\\') ++i;
  }
  return text.size();
}

std::optional<toml::source_position> find_excessive_nesting(std::string_view text, int limit) {
  int brackets = 0, dots = 0;  // open now; dots since the current key or number began
  std::size_t i = 0;
  while (i < text.size()) {
    const char c = text[i];
    if (c == '"' || c == '\'') {
      i = skip_string(text, i);
      continue;
    }
    if (c == '#') {
      i = std::min(text.find('\n', i), text.size());
      continue;
    }
    if (c == '.') ++dots;
    if (c == '[' || c == '{') ++brackets;
    if (c == ']' || c == '}') brackets = std::max(0, brackets - 1);
    if (std::string_view("[]{},=\n").find(c) != std::string_view::npos) dots = 0;
    if (brackets > limit || dots >= limit) return position_of(text, i);
    ++i;
  }
  return std::nullopt;
}

}  // namespace mica::host
