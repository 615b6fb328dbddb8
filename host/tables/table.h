#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace mica::host {

/// Rows of numbers.
struct Table {
  std::size_t rows = 0, columns = 0;
  std::vector<double> values;  ///< rows * columns, row by row
  std::vector<std::optional<std::size_t>> groups =
      {};  ///< first column of each of TableColumns' groups, if any

  double at(std::size_t row, std::size_t column) const { return values[row * columns + column]; }
};

/// The columns that a table may have: some always, and after them groups that come whole or not at all.
struct TableColumns {
  std::vector<std::string> required;
  std::vector<std::vector<std::string>> groups;
  std::vector<std::vector<std::size_t>>
      forms;  ///< groups of arrays without names, told by how many columns they have
};

/// A two-dimensional array of float32 or float64, of either byte order, C or Fortran order, of a NumPy file
/// (versions 1 to 3 of the format). Sizes are checked against the file's before anything is allocated.
/// Throws FileError when the file cannot be read or is damaged, UsageError for an array of another kind.
Table read_npy(const std::string& path);

/// Bytes of a NumPy file (version 1.0) that holds a float32 array of shape (n,), or of shape (n, columns)
/// when there are columns.
std::string to_npy(const std::vector<float>& values, std::size_t columns = 0);

/// A file of numbers with commas, semicolons or blanks between, as NumPy, pandas and R write it. Its first
/// line names the columns, in any order; it may be the last of several that begin with `#`. Names and numbers
/// may be in quotes, and a first column without a name is that of the rows. Empty lines and comments are left
/// out.
/// @param columns those that may be there; the table has them in this order.
/// Throws FileError when the file cannot be read, UsageError naming the line for everything else.
Table read_csv(const std::string& path, const TableColumns& columns);

}  // namespace mica::host
