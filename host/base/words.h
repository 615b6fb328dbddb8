#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace mica::host {

/// A value of an enum, as users write and read it.
template <typename Enum>
struct Word {
  std::string_view word;
  Enum value;
};

/// The words of an enum: specialised beside it, with `static constexpr Word<Enum> all[]`, every value once,
/// in the order in which they are listed to users. Words that stood for values in earlier versions may be in
/// a `former[]`: they are understood still, and not listed.
template <typename Enum>
struct Words;

template <typename Enum, typename = void>
constexpr bool has_former_words = false;
template <typename Enum>
constexpr bool has_former_words<Enum, std::void_t<decltype(Words<Enum>::former)>> = true;

/// The word for a value.
template <typename Enum>
constexpr std::string_view word_of(Enum value) {
  for (const Word<Enum>& entry : Words<Enum>::all)
    if (entry.value == value) return entry.word;
  return "";
}

/// The value that a word stands for, if it is one.
template <typename Enum>
std::optional<Enum> parse_word(std::string_view word) {
  for (const Word<Enum>& entry : Words<Enum>::all)
    if (entry.word == word) return entry.value;
  if constexpr (has_former_words<Enum>)
    for (const Word<Enum>& entry : Words<Enum>::former)
      if (entry.word == word) return entry.value;
  return std::nullopt;
}

/// All words.
template <typename Enum>
std::vector<std::string> list_words() {
  std::vector<std::string> words;
  for (const Word<Enum>& entry : Words<Enum>::all) words.emplace_back(entry.word);
  return words;
}

}  // namespace mica::host
