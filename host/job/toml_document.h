#pragma once

#include <toml++/toml.h>
#include <optional>
#include <string>
#include <string_view>

#include "host/job/issues.h"

namespace mica::host {

/// Parses TOML whose nodes remember `source_path`. Throws toml::parse_error, also for text that nests so
/// deeply that toml++ would run out of stack.
toml::table parse_toml(std::string_view text, const std::string& source_path);

/// Applies one `key.path=value` of --set to `root`; what is wrong with it becomes an issue.
void apply_override(toml::table& root, std::string_view assignment, Issues& issues);

/// What stands where something else was expected: `"wide" (a string)`, `a table`.
std::string describe(const toml::node& node);

/// First place where a key has more than `limit` parts, or brackets nest deeper than that. Reads the bare
/// text.
std::optional<toml::source_position> find_excessive_nesting(std::string_view text, int limit);

/// Position behind the TOML string that starts at `begin`, or behind the line or text that fails to close it.
std::size_t skip_string(std::string_view text, std::size_t begin);

}  // namespace mica::host
