#pragma once

#include <cstdint>
#include <string>

namespace mica::host::app {

/// One of several shares of rows, about equal.
struct Shard {
  std::uint64_t number = 1, of = 1;  ///< from 1

  std::uint64_t first(std::uint64_t rows) const { return share(number - 1, rows); }
  std::uint64_t end(std::uint64_t rows) const { return share(number, rows); }
  bool is_all() const { return of == 1; }

 private:
  /// floor(n rows / of), where the product need not fit.
  std::uint64_t share(std::uint64_t n, std::uint64_t rows) const {
    return rows / of * n + rows % of * n / of;
  }
};

/// Of `--shard K/N`; all of it when `text` is empty. Throws UsageError.
Shard parse_shard(const std::string& text);

/// "out/a.exr" of shard 3/16 is "out/a.part-03-of-16.exr".
std::string shard_name(const std::string& path, const Shard& shard);

}  // namespace mica::host::app
