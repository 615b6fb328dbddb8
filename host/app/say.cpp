#include "host/app/say.h"

#include <cstdio>

#include "host/base/printable.h"

namespace mica::host::app {

void say_text(const std::string& text) noexcept {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
  std::clearerr(stderr);
}

std::string presentable(const std::string& message) {
  constexpr std::size_t most_lines = 100, longest_line = 4000;
  std::string text;
  std::size_t lines = 0, more = 0;
  for (std::size_t begin = 0; begin <= message.size();) {
    const std::size_t end = std::min(message.find('\n', begin), message.size());
    if (lines < most_lines) {
      const std::string line =
          printable(std::string_view(message).substr(begin, std::min(end - begin, longest_line)));
      text += (lines ? "\n" : "") + line + (end - begin > longest_line ? "..." : "");
      ++lines;
    } else {
      ++more;
    }
    begin = end + 1;
  }
  return more ? text + fmt::format("\nand {} more lines", more) : text;
}

}  // namespace mica::host::app
