#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <string_view>

#include "host/tables/table.h"
#include "mica/error.h"

namespace mica::host {
namespace {

std::string_view trim(std::string_view text) {
  constexpr std::string_view blanks = " \t\r";
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> cells;
  for (std::size_t comma = line.find(','); comma != std::string_view::npos; comma = line.find(',')) {
    cells.push_back(trim(line.substr(0, comma)));
    line.remove_prefix(comma + 1);
  }
  cells.push_back(trim(line));
  return cells;
}

std::vector<std::string> all_names(const TableColumns& columns) {
  std::vector<std::string> names = columns.required;
  for (const std::vector<std::string>& group : columns.groups)
    names.insert(names.end(), group.begin(), group.end());
  return names;
}

class CsvReader {
 public:
  CsvReader(const std::string& path, const TableColumns& columns)
      : path_(path), columns_(columns), names_(all_names(columns)), stream_(path) {
    if (!stream_) throw FileError(path + ": no such file, or it cannot be read");
  }

  Table read() {
    std::string line;
    if (!next_line(&line)) fail(fmt::format("no header; expected {}", expected()));
    read_names(line);
    Table table;
    table.columns = order_.size();
    table.groups = place_groups();
    while (next_line(&line)) {
      read_row(line, &table.values);
      ++table.rows;
    }
    if (stream_.bad()) throw FileError(path_ + ": cannot be read");
    return table;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw UsageError(fmt::format("{}:{}: {}", path_, line_number_, what));
  }
  std::string expected() const {
    std::string text = fmt::format("{}", fmt::join(columns_.required, ","));
    for (const std::vector<std::string>& group : columns_.groups)
      text += fmt::format("[,{}]", fmt::join(group, ","));
    return text;
  }

  /// The next line that is not empty.
  bool next_line(std::string* line) {
    while (std::getline(stream_, *line)) {
      ++line_number_;
      if (!trim(*line).empty()) return true;
    }
    return false;
  }

  void read_names(std::string_view line) {
    constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
    if (line.substr(0, byte_order_mark.size()) == byte_order_mark) line.remove_prefix(byte_order_mark.size());
    line = trim(line);
    if (line.substr(0, 1) == "#") line = trim(line.substr(1));
    const std::vector<std::string_view> cells = split(line);
    for (const std::string_view cell : cells) {
      const auto found = std::find(names_.begin(), names_.end(), cell);
      if (found == names_.end()) fail(fmt::format("the header names \"{}\"; expected {}", cell, expected()));
      const auto column = static_cast<std::size_t>(found - names_.begin());
      if (std::count(order_.begin(), order_.end(), column))
        fail(fmt::format("column {} appears twice", *found));
      order_.push_back(column);
    }
    place_ = order_;
    require(0, columns_.required.size());
  }

  bool has(std::size_t column) const { return std::count(order_.begin(), order_.end(), column) > 0; }
  void require(std::size_t first, std::size_t count) const {
    for (std::size_t column = first; column < first + count; ++column)
      if (!has(column)) fail(fmt::format("column {} is missing; expected {}", names_[column], expected()));
  }

  /// Moves the columns of each group that is there to where the table has them.
  std::vector<std::optional<std::size_t>> place_groups() {
    std::vector<std::optional<std::size_t>> groups;
    std::size_t named = columns_.required.size(), placed = named;  // columns of the groups before
    for (const std::vector<std::string>& group : columns_.groups) {
      const std::size_t first = named;
      named += group.size();
      groups.emplace_back();
      bool any = false;
      for (std::size_t column = first; column < named; ++column) any |= has(column);
      if (!any) continue;
      require(first, group.size());
      for (std::size_t& column : place_)
        if (column >= first && column < named) column -= first - placed;
      groups.back() = placed;
      placed += group.size();
    }
    return groups;
  }

  void read_row(std::string_view line, std::vector<double>* values) const {
    const std::vector<std::string_view> cells = split(line);
    if (cells.size() != order_.size())
      fail(fmt::format("{} values; the header names {} columns", cells.size(), order_.size()));
    const std::size_t first = values->size();
    values->resize(first + cells.size());
    for (std::size_t n = 0; n < cells.size(); ++n) {
      const char* end = cells[n].data() + cells[n].size();
      double value = 0;
      const auto [stop, error] = std::from_chars(cells[n].data(), end, value);
      if (error != std::errc() || stop != end)
        fail(fmt::format("column {}: \"{}\" is not a number", names_[order_[n]], cells[n]));
      (*values)[first + place_[n]] = value;
    }
  }

  const std::string& path_;
  const TableColumns& columns_;
  const std::vector<std::string> names_;
  std::ifstream stream_;
  std::size_t line_number_ = 0;
  std::vector<std::size_t> order_,
      place_;  // which of `names_` each column of the file is, and where in the table
};

}  // namespace

Table read_csv(const std::string& path, const TableColumns& columns) {
  return CsvReader(path, columns).read();
}

}  // namespace mica::host
