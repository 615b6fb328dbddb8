#pragma once

#include <string>
#include <string_view>

namespace mica::host {

/// `text` on one line, with its control characters escaped: a terminal must not obey what a file says.
std::string printable(std::string_view text);

/// `text` printable, and cut when it is long.
std::string shortened(std::string_view text);

}  // namespace mica::host
