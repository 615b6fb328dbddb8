#include "host/app/shard.h"

#include <fmt/format.h>

#include <charconv>
#include <filesystem>

#include "mica/error.h"

namespace mica::host::app {

Shard parse_shard(const std::string& text) {
  if (text.empty()) return {};
  constexpr std::uint64_t most = 1000000;
  Shard shard;
  const char* const end = text.data() + text.size();
  const auto number = std::from_chars(text.data(), end, shard.number);
  const bool has_slash = number.ec == std::errc() && number.ptr != end && *number.ptr == '/';
  const auto of = std::from_chars(has_slash ? number.ptr + 1 : end, end, shard.of);
  if (!has_slash || of.ec != std::errc() || of.ptr != end || shard.number < 1 || shard.number > shard.of ||
      shard.of > most)
    throw UsageError(fmt::format("--shard {}: expected K/N, K from 1 to N, N at most {}", text, most));
  return shard;
}

std::string shard_name(const std::string& path, const Shard& shard) {
  const std::filesystem::path file(path);
  const std::size_t digits = fmt::formatted_size("{}", shard.of);
  return (file.parent_path() / fmt::format("{}.part-{:0{}}-of-{}{}", file.stem().string(), shard.number,
                                           digits, shard.of, file.extension().string()))
      .string();
}

}  // namespace mica::host::app
