#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace mica::host {

/// Rows of numbers.
struct Table {
  std::size_t rows = 0, columns = 0;
  std::vector<double> values;  ///< rows * columns, row by row

  double at(std::size_t row, std::size_t column) const { return values[row * columns + column]; }
};

/// A two-dimensional array of float32 or float64, little endian, C or Fortran order, of a NumPy file
/// (versions 1 to 3 of the format). Sizes are checked against the file's before anything is allocated.
/// Throws FileError when the file cannot be read or is damaged, UsageError for an array of another kind.
Table read_npy(const std::string& path);

/// Bytes of a NumPy file (version 1.0) that holds a float32 array of shape (n,), or of shape (n, columns)
/// when there are columns.
std::string to_npy(const std::vector<float>& values, std::size_t columns = 0);

/// A comma-separated file. Its first line names the columns, in any order; it may begin with `#`, as NumPy
/// writes it. Empty lines are left out.
/// @param names the columns that may be there; the table has them in this order.
/// @param required that many of them, from the first, have to be there; the others come all or not at all.
/// Throws FileError when the file cannot be read, UsageError naming the line for everything else.
Table read_csv(const std::string& path, const std::vector<std::string>& names, std::size_t required);

}  // namespace mica::host
