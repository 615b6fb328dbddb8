#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "host/base/atomic_file.h"
#include "host/base/hash.h"

namespace mica::host {

/// What a file with some rows of answers says of them.
struct TablePart {
  std::uint64_t shard = 1, shards = 1;
  std::uint64_t first = 0, count = 0;           ///< rows of all
  std::uint64_t rows = 0, columns = 0;          ///< of all answers; 0 columns: one number a row
  std::map<std::string, std::string> identity;  ///< that all parts of a table share

  std::uint64_t value_bytes() const { return count * (columns ? columns : 1) * sizeof(float); }
};

/// Answers on their way into a file, which appears whole or not at all.
class ValueFile {
 public:
  /// A NumPy file, as npy_header says.
  ValueFile(const std::string& path, std::size_t rows, std::size_t columns);
  /// A part, for join_tables: a line of JSON, the values, and a hash of both.
  ValueFile(const std::string& path, const TablePart& part);

  void append(const std::vector<float>& values);
  /// Call once, after all values.
  void finish();

 private:
  AtomicFile file_;
  Hash hash_;
  bool is_part_;
};

/// Writes the NumPy file that its parts make. @return its rows.
/// Throws FileError naming every part that cannot be read, is cut short or damaged; UsageError naming every
/// one that is of another table or has rows that another one has as well, and the rows that none has.
std::uint64_t join_tables(const std::vector<std::string>& parts, const std::string& output);

}  // namespace mica::host
