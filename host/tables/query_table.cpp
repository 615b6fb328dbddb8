#include "host/tables/query_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>

#include "mica/error.h"

namespace mica::host {
namespace {

const std::vector<std::string> kColumns = {"u", "v", "cuu", "cuv", "cvv", "s", "t", "roughness"};
constexpr std::size_t kMaxNamed = 10;  // rows that an error names

}  // namespace

Table read_query_table(const std::string& path, const std::vector<std::string>& columns) {
  const std::size_t required = columns.size() - 1;
  const std::string extension = std::filesystem::path(path).extension().string();
  if (extension == ".csv") return read_csv(path, columns, required);
  if (extension != ".npy") throw UsageError(fmt::format("{}: expected a .npy or .csv file of queries", path));
  Table table = read_npy(path);
  if (table.columns != required && table.columns != columns.size())
    throw UsageError(fmt::format("{}: {} columns; expected {} or {}: {} and, if it differs by row, {}", path,
                                 table.columns, required, columns.size(),
                                 fmt::join(columns.begin(), columns.end() - 1, " "), columns.back()));
  return table;
}

void check_rows(const std::string& path, std::size_t count,
                const std::function<std::string(std::size_t)>& problem_of) {
  std::size_t problems = 0;
  std::string named;
  for (std::size_t row = 0; row < count; ++row) {
    const std::string problem = problem_of(row);
    if (problem.empty()) continue;
    if (++problems <= kMaxNamed) named += fmt::format("\n  row {}: {}", row, problem);
  }
  if (problems == 0) return;
  if (problems > kMaxNamed) named += fmt::format("\n  and {} more", problems - kMaxNamed);
  throw UsageError(fmt::format("{}: {} of {} rows cannot be evaluated (rows count from 0):{}", path, problems,
                               count, named));
}

QueryTable::QueryTable(const std::string& path, std::optional<double> roughness, const std::string& option)
    : path_(path), table_(read_query_table(path, kColumns)) {
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
  check_rows(path_, size(), [&](std::size_t row) { return problem_of(query(row)); });
}

}  // namespace mica::host
