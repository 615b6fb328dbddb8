#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>
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

/// A table of which some rows at a time are in memory.
class RowSource {
 public:
  virtual ~RowSource() = default;
  virtual std::size_t rows() const = 0;
  virtual std::size_t columns() const = 0;
  /// Rows `first` to `first + count - 1`, row by row. Throws FileError.
  virtual std::vector<double> read(std::size_t first, std::size_t count) const = 0;

  std::vector<std::optional<std::size_t>> groups = {};  ///< as Table's
};

/// Rows that are in memory.
class TableRows : public RowSource {
 public:
  explicit TableRows(Table table) : table_(std::move(table)) { groups = table_.groups; }
  std::size_t rows() const override { return table_.rows; }
  std::size_t columns() const override { return table_.columns; }
  std::vector<double> read(std::size_t first, std::size_t count) const override {
    const auto begin = table_.values.begin() + static_cast<std::ptrdiff_t>(first * table_.columns);
    return {begin, begin + static_cast<std::ptrdiff_t>(count * table_.columns)};
  }

 private:
  Table table_;
};

/// A two-dimensional array of float32 or float64, of either byte order, C or Fortran order, of a NumPy file
/// (versions 1 to 3 of the format), which stays open. Sizes are checked against the file's before anything is
/// allocated. Throws FileError when the file cannot be read or is damaged, UsageError for an array of another
/// kind.
std::unique_ptr<RowSource> open_npy(const std::string& path);

/// What a NumPy file (version 1.0) begins with that holds a float32 array of shape (rows,), or of shape
/// (rows, columns) when there are columns; its values follow, row by row.
std::string npy_header(std::size_t rows, std::size_t columns = 0);

/// Bytes of such a file.
std::string to_npy(const std::vector<float>& values, std::size_t columns = 0);

/// A file of numbers with commas, semicolons or blanks between, as NumPy, pandas and R write it. Its first
/// line names the columns, in any order; it may be the last of several that begin with `#`. Names and numbers
/// may be in quotes, and a first column without a name is that of the rows. Empty lines and comments are left
/// out.
/// @param columns those that may be there; the table has them in this order.
/// Throws FileError when the file cannot be read, UsageError naming the line for everything else.
Table read_csv(const std::string& path, const TableColumns& columns);

}  // namespace mica::host
