#pragma once

#include <functional>
#include <optional>
#include <string>

#include "host/app/table.h"
#include "host/base/query.h"

namespace mica::app {

/// Queries of a file: rows u v cuu cuv cvv s t [roughness], uv in map periods, covariance in uv^2 units, half
/// vector on the unit disk.
class QueryTable {
 public:
  /// Reads a .npy or .csv file.
  /// @param roughness of all rows, unless the file has that column. @param option that gives it.
  /// Throws FileError (unreadable, damaged) or UsageError (other columns, or no roughness at all).
  QueryTable(const std::string& path, std::optional<double> roughness,
             const std::string& option = "--roughness");

  std::size_t size() const { return table_.rows; }
  Query query(std::size_t row) const;

  /// Throws UsageError naming the first ten rows that cannot be evaluated, and why, and how many there are.
  /// @param problem of a query: why it cannot, or empty.
  void check(const std::function<std::string(const Query&)>& problem) const;

 private:
  std::string path_;
  Table table_;
  double roughness_ = 0;  // where the table has no such column
};

}  // namespace mica::app
