#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "host/base/query.h"
#include "host/tables/query_table.h"

namespace mica::host {

/// What a row of a patch's table asks for.
enum class PatchQuantity {
  brdf,    ///< u v cuu cuv cvv ox oy oz ix iy iz [roughness]
  energy,  ///< u v cuu cuv cvv ox oy oz [roughness]
  sample   ///< the same
};

/// Queries of a file about a patch BRDF. Directions may have any length but 0, and are normalised.
class PatchTable {
 public:
  /// Reads a .npy or .csv file.
  /// @param roughness of all rows, unless the file has that column.
  /// Throws FileError (unreadable, damaged) or UsageError (other columns, or no roughness at all).
  PatchTable(const std::string& path, PatchQuantity quantity, std::optional<double> roughness);

  std::size_t size() const { return table_.source().rows(); }
  const RowSource& source() const { return table_.source(); }
  /// @param view_problem why a view cannot be answered, or empty. Throws UsageError naming the rows that
  /// cannot be, see `NamedRows`.
  void check(const TableRange& rows, const std::function<std::string(const ViewQuery&)>& view_problem) const;

  BrdfQuery brdf(std::size_t row) const;
  ViewQuery view(std::size_t row) const;
  /// @param seed with which, and the row, its random numbers begin.
  SampleQuery sample(std::size_t row, std::uint64_t seed) const;

 private:
  Eigen::Vector3d direction(std::size_t row, std::size_t column) const;

  std::string path_;
  PatchQuantity quantity_;
  std::size_t columns_ = 0;  // without roughness
  RowWindow table_;
  double roughness_ = 0;  // where the table has no such column
};

}  // namespace mica::host
