#include "host/app/query_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>

#include "host/base/error.h"

namespace mica::app {
namespace {

const std::vector<std::string> kColumns = {"u", "v", "cuu", "cuv", "cvv", "s", "t", "roughness"};
constexpr std::size_t kRequired = 7;
constexpr std::size_t kMaxNamed = 10;  // rows that an error names

Table read_table(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension().string();
  if (extension == ".csv") return read_csv(path, kColumns, kRequired);
  if (extension != ".npy") throw UsageError(fmt::format("{}: expected a .npy or .csv file of queries", path));
  Table table = read_npy(path);
  if (table.columns != kRequired && table.columns != kColumns.size())
    throw UsageError(fmt::format("{}: {} columns; expected 7 or 8: {} and, if it differs by row, roughness",
                                 path, table.columns,
                                 fmt::join(kColumns.begin(), kColumns.begin() + kRequired, " ")));
  return table;
}

}  // namespace

QueryTable::QueryTable(const std::string& path, std::optional<double> roughness, const std::string& option)
    : path_(path), table_(read_table(path)) {
  if (table_.columns == kColumns.size()) return;
  if (!roughness) throw UsageError(fmt::format("{}: has no column roughness, so {} is needed", path, option));
  roughness_ = *roughness;
}

Query QueryTable::query(std::size_t row) const {
  Query query;
  query.footprint.mean_uv = {table_.at(row, 0), table_.at(row, 1)};
  query.footprint.cov_uv << table_.at(row, 2), table_.at(row, 3), table_.at(row, 3), table_.at(row, 4);
  query.half_vector = {table_.at(row, 5), table_.at(row, 6)};
  query.roughness = table_.columns == kColumns.size() ? table_.at(row, 7) : roughness_;
  return query;
}

void QueryTable::check(const std::function<std::string(const Query&)>& problem_of) const {
  std::size_t count = 0;
  std::string named;
  for (std::size_t row = 0; row < size(); ++row) {
    const std::string problem = problem_of(query(row));
    if (problem.empty()) continue;
    if (++count <= kMaxNamed) named += fmt::format("\n  row {}: {}", row, problem);
  }
  if (count == 0) return;
  if (count > kMaxNamed) named += fmt::format("\n  and {} more", count - kMaxNamed);
  throw UsageError(fmt::format("{}: {} of {} rows cannot be evaluated (rows count from 0):{}", path_, count,
                               size(), named));
}

}  // namespace mica::app
