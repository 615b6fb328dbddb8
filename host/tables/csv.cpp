#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <utility>

#include "host/base/printable.h"
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

/// R and pandas put names, and some numbers, in quotes.
std::string_view unquoted(std::string_view cell) {
  cell = trim(cell);
  const bool is_quoted = cell.size() >= 2 && cell.front() == '"' && cell.back() == '"';
  return is_quoted ? trim(cell.substr(1, cell.size() - 2)) : cell;
}

/// @param separator a blank stands for any number of blanks and tabs, as NumPy writes them.
std::vector<std::string_view> split(std::string_view line, char separator) {
  const std::string_view separators = separator == ' ' ? " \t" : separator == ';' ? ";" : ",";
  std::vector<std::string_view> cells;
  for (std::size_t end; (end = line.find_first_of(separators)) != std::string_view::npos;) {
    cells.push_back(unquoted(line.substr(0, end)));
    line.remove_prefix(separator == ' ' ? line.find_first_not_of(separators, end) : end + 1);
  }
  cells.push_back(unquoted(line));
  return cells;
}

char separator_of(std::string_view header) {
  for (const char separator : {',', ';'})
    if (header.find(separator) != std::string_view::npos) return separator;
  return ' ';
}

bool to_number(std::string_view cell, double* value) {
  if (cell.size() > 1 && cell.front() == '+' && cell[1] != '-') cell.remove_prefix(1);
  const char* const end = cell.data() + cell.size();
  const auto [stop, error] = std::from_chars(cell.data(), end, *value);
  if (stop != end || error == std::errc()) return stop == end && error == std::errc();
  if (error != std::errc::result_out_of_range) return false;
  *value = std::strtod(std::string(cell).c_str(), nullptr);
  return std::isfinite(*value);  // too small for a double is 0, too large is nothing
}

bool is_comment(std::string_view line) {
  return trim(line).substr(0, 1) == "#";
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
    std::error_code ignored;
    if (std::filesystem::is_directory(path, ignored))
      throw FileError(path + ": is a folder, expected a table");
    if (!stream_) throw FileError(path + ": no such file, or it cannot be read");
  }

  Table read() {
    std::string line;
    bool is_row = read_header(&line);
    Table table;
    table.columns = order_.size();
    table.groups = place_groups();
    for (; is_row || next_line(&line); is_row = false) {
      if (is_comment(line)) continue;
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

  /// The names are in the last comment before the numbers, or in the first line that is no comment.
  /// @return whether `line` is the first row, which was looked at.
  bool read_header(std::string* line) {
    constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
    std::string names;
    std::size_t at = 0;
    bool is_there = next_line(line);
    if (is_there && line->compare(0, byte_order_mark.size(), byte_order_mark) == 0)
      line->erase(0, byte_order_mark.size());
    for (; is_there && is_comment(*line); is_there = next_line(line)) names = *line, at = line_number_;
    double number = 0;
    const bool is_row =
        is_there && !names.empty() && to_number(split(trim(*line), separator_of(trim(*line)))[0], &number);
    if (!is_row && is_there) names = *line, at = line_number_;
    if (names.empty()) fail(fmt::format("no header; expected {}", expected()));
    const std::size_t row_at = std::exchange(line_number_, at);
    read_names(names);
    line_number_ = row_at;
    return is_row;
  }

  void read_names(std::string_view line) {
    line = trim(line);
    if (line.substr(0, 1) == "#") line = trim(line.substr(1));
    separator_ = separator_of(line);
    std::vector<std::string_view> cells = split(line, separator_);
    has_index_ = separator_ != ' ' && cells[0].empty();  // the names of rows, by pandas and R
    if (has_index_) cells.erase(cells.begin());
    for (const std::string_view cell : cells) {
      const auto found = std::find(names_.begin(), names_.end(), cell);
      if (found == names_.end())
        fail(fmt::format("the header names \"{}\"; expected {}", shortened(cell), expected()));
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
    std::vector<std::string_view> cells = split(trim(line), separator_);
    if (has_index_) cells.erase(cells.begin());
    if (cells.size() != order_.size())
      fail(fmt::format("{} values; the header names {} columns", cells.size(), order_.size()));
    const std::size_t first = values->size();
    values->resize(first + cells.size());
    for (std::size_t n = 0; n < cells.size(); ++n) {
      double value = 0;
      if (!to_number(cells[n], &value))
        fail(fmt::format("column {}: \"{}\" is not a number", names_[order_[n]], shortened(cells[n])));
      (*values)[first + place_[n]] = value;
    }
  }

  const std::string& path_;
  const TableColumns& columns_;
  const std::vector<std::string> names_;
  std::ifstream stream_;
  std::size_t line_number_ = 0;
  char separator_ = ',';
  bool has_index_ = false;  // a first column that names rows
  std::vector<std::size_t> order_,
      place_;  // which of `names_` each column of the file is, and where in the table
};

}  // namespace

Table read_csv(const std::string& path, const TableColumns& columns) {
  return CsvReader(path, columns).read();
}

}  // namespace mica::host
