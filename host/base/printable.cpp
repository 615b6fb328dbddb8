#include "host/base/printable.h"

#include <fmt/format.h>

namespace mica::host {
namespace {

/// Bytes of the UTF-8 character that `text` begins with, if it is one to be shown; 0 otherwise.
std::size_t shown_character(std::string_view text) {
  const auto byte = [&](std::size_t n) { return static_cast<unsigned char>(text[n]); };
  const unsigned char first = byte(0);
  if (first < 0x80) return first >= 0x20 && first != 0x7f ? 1 : 0;
  const std::size_t size = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  if (first < 0xc2 || first > 0xf4 || text.size() < size) return 0;
  for (std::size_t n = 1; n < size; ++n)
    if ((byte(n) & 0xc0) != 0x80) return 0;
  return first == 0xc2 && byte(1) < 0xa0 ? 0 : size;  // control characters of Latin 1
}

}  // namespace

std::string printable(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    const std::size_t size = shown_character(text);
    if (size > 0)
      result += text.substr(0, size);
    else
      result += fmt::format("\\x{:02x}", static_cast<unsigned char>(text[0]));
    text.remove_prefix(size > 0 ? size : 1);
  }
  return result;
}

std::string shortened(std::string_view text) {
  constexpr std::size_t longest = 80;
  if (text.size() <= longest) return printable(text);
  std::size_t end = longest;
  while (end > 0 && (text[end] & 0xc0) == 0x80) --end;  // do not cut inside a UTF-8 sequence
  return printable(text.substr(0, end)) + "...";
}

}  // namespace mica::host
