#include "host/tables/query_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "host/base/hash.h"
#include "mica/error.h"

namespace mica::host {
namespace {

enum Group { kRoughness, kLobe, kTurn };
const TableColumns kColumns = {{"u", "v", "cuu", "cuv", "cvv", "s", "t"},
                               {{"roughness"}, {"rss", "rst", "rtt"}, {"su", "sv", "tu", "tv"}},
                               {{}, {kRoughness}, {kLobe, kTurn}}};
constexpr std::size_t kMaxNamed = 10;  // rows that an error names

/// Columns of an array with the groups of a form.
std::vector<std::string> names_of(const TableColumns& columns, const std::vector<std::size_t>& form) {
  std::vector<std::string> names = columns.required;
  for (const std::size_t group : form)
    names.insert(names.end(), columns.groups[group].begin(), columns.groups[group].end());
  return names;
}

/// Tells the groups of an array by its number of columns.
void place_groups(const std::string& path, const TableColumns& columns, RowSource* table) {
  std::string expected;
  for (const std::vector<std::size_t>& form : columns.forms) {
    const std::vector<std::string> names = names_of(columns, form);
    expected += fmt::format("\n  {}: {}", names.size(), fmt::join(names, " "));
    if (names.size() != table->columns()) continue;
    table->groups.assign(columns.groups.size(), std::nullopt);
    std::size_t first = columns.required.size();
    for (const std::size_t group : form) table->groups[group] = first, first += columns.groups[group].size();
    return;
  }
  throw UsageError(fmt::format("{}: {} columns; expected one of{}", path, table->columns(), expected));
}

}  // namespace

std::unique_ptr<RowSource> open_query_table(const std::string& path, const TableColumns& columns) {
  std::string extension = std::filesystem::path(path).extension().string();
  for (char& letter : extension) letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  if (extension == ".csv") return std::make_unique<TableRows>(read_csv(path, columns));
  if (extension != ".npy") throw UsageError(fmt::format("{}: expected a .npy or .csv file of queries", path));
  std::unique_ptr<RowSource> table = open_npy(path);
  place_groups(path, columns, table.get());
  return table;
}

std::unique_ptr<RowSource> open_query_table(const std::string& path,
                                            const std::vector<std::string>& columns) {
  const TableColumns table_columns = {{columns.begin(), columns.end() - 1}, {{columns.back()}}, {{}, {0}}};
  return open_query_table(path, table_columns);
}

Table read_query_table(const std::string& path, const std::vector<std::string>& columns) {
  const std::unique_ptr<RowSource> source = open_query_table(path, columns);
  return {source->rows(), source->columns(), source->read(0, source->rows()), source->groups};
}

double RowWindow::at(std::size_t row, std::size_t column) const {
  constexpr std::size_t size = 256;  // rows: few enough to be read for one of them
  const std::size_t columns = source_->columns();
  if (row < first_ || row - first_ >= values_.size() / std::max<std::size_t>(columns, 1)) {
    first_ = row / size * size;
    values_ = source_->read(first_, std::min(size, source_->rows() - first_));
  }
  return values_[(row - first_) * columns + column];
}

std::string fingerprint(const RowSource& source) {
  constexpr std::size_t most = 4096;
  Hash hash;
  hash.add(fmt::format("{} x {}", source.rows(), source.columns()));
  const std::size_t count = std::min(source.rows(), most);
  for (std::size_t n = 0; n < count; ++n) {
    const std::vector<double> row = source.read(n * (source.rows() / count), 1);
    hash.add(row.data(), row.size() * sizeof(double));
  }
  return hash.digits();
}

void check_rows(const std::string& path, const TableRange& rows,
                const std::function<std::string(std::size_t)>& problem_of) {
  std::size_t problems = 0;
  std::string named;
  for (std::size_t row = rows.first; row < rows.end; ++row) {
    const std::string problem = problem_of(row);
    if (problem.empty()) continue;
    if (++problems <= kMaxNamed) named += fmt::format("\n  row {}: {}", row, problem);
  }
  if (problems == 0) return;
  if (problems > kMaxNamed) named += fmt::format("\n  and {} more", problems - kMaxNamed);
  throw UsageError(fmt::format("{}: {} of {} rows cannot be evaluated (rows count from 0):{}", path, problems,
                               rows.count(), named));
}

QueryTable::QueryTable(const std::string& path, std::optional<double> roughness, const std::string& option)
    : path_(path), table_(open_query_table(path, kColumns)) {
  const auto& groups = table_.source().groups;
  if (groups[kRoughness] && groups[kLobe])
    throw UsageError(
        fmt::format("{}: has both roughness and rss, rst, rtt; one of them says what the lobe is", path));
  if (groups[kRoughness] || groups[kLobe]) return;
  if (!roughness) throw UsageError(fmt::format("{}: has no column roughness, so {} is needed", path, option));
  roughness_ = *roughness;
}

Query QueryTable::query(std::size_t row) const {
  const auto& groups = table_.source().groups;
  Query query;
  query.footprint.mean_uv = {table_.at(row, 0), table_.at(row, 1)};
  query.footprint.cov_uv << table_.at(row, 2), table_.at(row, 3), table_.at(row, 3), table_.at(row, 4);
  query.half_vector = {table_.at(row, 5), table_.at(row, 6)};
  query.roughness = groups[kRoughness] ? table_.at(row, *groups[kRoughness]) : roughness_;
  if (const std::optional<std::size_t> lobe = groups[kLobe]) {
    query.lobe_cov.emplace();
    *query.lobe_cov << table_.at(row, *lobe), table_.at(row, *lobe + 1), table_.at(row, *lobe + 1),
        table_.at(row, *lobe + 2);
  }
  if (const std::optional<std::size_t> turn = groups[kTurn])
    query.half_vector_turn << table_.at(row, *turn), table_.at(row, *turn + 1), table_.at(row, *turn + 2),
        table_.at(row, *turn + 3);
  return query;
}

void QueryTable::check(const TableRange& rows,
                       const std::function<std::string(const Query&)>& problem_of) const {
  check_rows(path_, rows, [&](std::size_t row) { return problem_of(query(row)); });
}

}  // namespace mica::host
