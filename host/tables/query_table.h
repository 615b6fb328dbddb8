#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/base/query.h"
#include "host/tables/table.h"

namespace mica::host {

/// Reads a .npy or .csv file of queries. Throws FileError (unreadable, damaged) or UsageError (other
/// columns).
Table read_query_table(const std::string& path, const TableColumns& columns);

/// The same. @param columns the names of its columns; the last one may be missing.
Table read_query_table(const std::string& path, const std::vector<std::string>& columns);

/// Throws UsageError naming the first ten of the rows 0 .. count - 1 that cannot be evaluated, and why, and
/// how many there are. @param problem of a row: why it cannot, or empty.
void check_rows(const std::string& path, std::size_t count,
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

  std::size_t size() const { return table_.rows; }
  Query query(std::size_t row) const;

  /// Throws as `check_rows` does. @param problem of a query: why it cannot be evaluated, or empty.
  void check(const std::function<std::string(const Query&)>& problem) const;

 private:
  std::string path_;
  Table table_;
  double roughness_ = 0;  // where the table says nothing of the lobe
};

}  // namespace mica::host
