#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host/base/query.h"
#include "host/tables/table.h"

namespace mica::host {

/// Opens a .npy or .csv file of queries; the latter is read into memory. Throws FileError (unreadable,
/// damaged) or UsageError (other columns).
std::unique_ptr<RowSource> open_query_table(const std::string& path, const TableColumns& columns);

/// The same. @param columns the names of its columns; the last one may be missing.
std::unique_ptr<RowSource> open_query_table(const std::string& path, const std::vector<std::string>& columns);

/// Reads all of it.
Table read_query_table(const std::string& path, const std::vector<std::string>& columns);

/// Some rows of a table at a time, kept for whoever asks for them one by one.
class RowWindow {
 public:
  explicit RowWindow(std::unique_ptr<RowSource> source) : source_(std::move(source)) {}
  const RowSource& source() const { return *source_; }
  double at(std::size_t row, std::size_t column) const;

 private:
  std::unique_ptr<RowSource> source_;
  mutable std::vector<double> values_;
  mutable std::size_t first_ = 0;
};

/// A hash of a table's shape and of 4096 of its rows at equal distances: tells tables apart.
std::string fingerprint(const RowSource& source);

/// Rows `first` to `end` - 1.
struct TableRange {
  std::size_t first = 0, end = 0;

  std::size_t count() const { return end - first; }
};

/// Throws UsageError naming the first ten of the rows that cannot be evaluated, and why, and how many there
/// are. @param problem of a row: why it cannot, or empty.
void check_rows(const std::string& path, const TableRange& rows,
                const std::function<std::string(std::size_t)>& problem);

/// Queries of a file: rows u v cuu cuv cvv s t [roughness | rss rst rtt] [su sv tu tv], uv in map periods,
/// covariance in uv^2 units, half vector on the unit disk, the lobe's covariance there, and the half vector's
/// turn per unit of uv. Arrays, which do not name their columns, have 7, 8 or all 14 with the lobe's
/// covariance.
class QueryTable {
 public:
  /// Reads a .npy or .csv file.
  /// @param roughness of all rows, unless the file says what the lobe is. @param option that gives it.
  /// Throws FileError (unreadable, damaged) or UsageError (other columns, or no roughness at all).
  QueryTable(const std::string& path, std::optional<double> roughness,
             const std::string& option = "--roughness");

  std::size_t size() const { return table_.source().rows(); }
  const RowSource& source() const { return table_.source(); }
  /// Quick for rows that follow each other; not for several threads.
  Query query(std::size_t row) const;

  /// Throws as `check_rows` does. @param problem of a query: why it cannot be evaluated, or empty.
  void check(const TableRange& rows, const std::function<std::string(const Query&)>& problem) const;
  void check(const std::function<std::string(const Query&)>& problem) const { check({0, size()}, problem); }

 private:
  std::string path_;
  RowWindow table_;
  double roughness_ = 0;  // where the table says nothing of the lobe
};

}  // namespace mica::host
