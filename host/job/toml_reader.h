#pragma once

#include <toml++/toml.h>
#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "host/base/words.h"
#include "host/image/picture.h"
#include "host/job/issues.h"

namespace mica::host {

/// The numbers that a key takes; an end may be excluded. NaN and infinities are in none.
struct Interval {
  double low, high;
  bool open_low = false, open_high = false;

  bool contains(double x) const;
};
constexpr Interval closed(double low, double high) {
  return {low, high, false, false};
}
constexpr Interval open(double low, double high) {
  return {low, high, true, true};
}
constexpr Interval open_low(double low, double high) {
  return {low, high, true, false};
}

/// Words that a key takes, and what each means.
template <typename T>
using Choices = std::vector<std::pair<std::string_view, T>>;

/// What the readers of one job share.
struct ReadContext {
  Issues& issues;
  std::filesystem::path folder;  ///< that file names are relative to
  std::uint64_t max_bytes = 0;   ///< see PictureChoice
};

/// One table of a job. Each `read` leaves its target alone when the key is absent, and reports a value
/// that is wrong. A key that nobody asked for is reported once the table has been read.
class TableReader {
 public:
  using Visitor = std::function<void(TableReader&)>;

  /// Reads the root of a document.
  static void read_root(const toml::table& root, ReadContext& context, const Visitor& visit);

  /// Last part of the table's path: NAME of `[material.NAME]`.
  const std::string& name() const { return name_; }
  bool has(std::string_view key) const { return table_.contains(key); }

  /// Reports an absent key. `expected` completes "expected ...". Returns whether the key is there.
  bool require(std::string_view key, std::string_view expected);

  void read(std::string_view key, int& value, const Interval& range);
  void read(std::string_view key, double& value, const Interval& range);
  /// A non-negative 64-bit integer.
  void read(std::string_view key, std::uint64_t& value);
  /// A string that is not empty.
  void read(std::string_view key, std::string& value);
  /// An array of exactly N numbers.
  template <int N>
  void read(std::string_view key, Eigen::Matrix<double, N, 1>& value, const Interval& range) {
    read_numbers(key, value.data(), N, range);
  }
  /// A number, which stands for both, or an array of 2 numbers.
  void read_one_or_two(std::string_view key, Eigen::Vector2d& value, const Interval& range);
  /// An array of 1 to `most` arrays of 3 numbers.
  void read(std::string_view key, std::vector<Eigen::Vector3d>& values, std::size_t most,
            const Interval& range);
  template <typename T>
  void read(std::string_view key, T& value, const Choices<T>& choices);
  /// One of the words of an enum.
  template <typename Enum, typename = std::enable_if_t<std::is_enum_v<Enum>>>
  void read(std::string_view key, Enum& value) {
    Choices<Enum> choices;
    for (const Word<Enum>& entry : Words<Enum>::all) choices.emplace_back(entry.word, entry.value);
    read(key, value, choices);
  }
  /// Any of `choices`, each at most once.
  void read(std::string_view key, std::vector<std::string>& values,
            const std::vector<std::string_view>& choices);
  /// One of `names`, which are those of the job's tables `[kind.NAME]`.
  void read_reference(std::string_view key, std::string& value, std::string_view kind,
                      const std::vector<std::string_view>& names);
  /// An existing file; `path` is then what opens it.
  void read_file(std::string_view key, std::string& path);

  /// `part` and `channels`, of a file that is a picture.
  void read_choice(PictureChoice& choice);

  /// The table at `key`, when there is one.
  void read_table(std::string_view key, const Visitor& visit);
  /// Each `[key.NAME]`, by name.
  void read_named_tables(std::string_view key, const Visitor& visit);
  /// Each `[[key]]`, in order; at least one is required.
  void read_table_array(std::string_view key, const Visitor& visit);

  /// Reports `message` about the table.
  void report(std::string_view message);
  /// Reports `message` about the value of `key`, or about the table when it has none.
  void report(std::string_view key, std::string_view message);
  /// For a table whose kind is not known: any of its keys may be right.
  void accept_any_key() { accepts_any_key_ = true; }

 private:
  TableReader(const toml::table& table, std::string path, std::string name, ReadContext& context);

  void visit(const Visitor& visitor);
  void visit_child(const toml::node& child, const std::string& path, const std::string& name,
                   const Visitor& visitor);
  const toml::node* find(std::string_view key);
  const std::string* find_text(std::string_view key);
  std::string path_of(std::string_view key) const;
  void report_at(const toml::node& node, const std::string& path, std::string_view message);
  void report_unexpected(const toml::node& node, const std::string& path, std::string_view expected);
  bool read_number(const toml::node& node, const std::string& path, double& value, const Interval& range);
  void read_numbers(std::string_view key, double* values, std::size_t count, const Interval& range);
  void read_numbers(const toml::node& node, const std::string& path, double* values, std::size_t count,
                    const Interval& range);
  /// Index of the string `node` in `words`; when it is none of them, their number, and a report.
  std::size_t choose(const toml::node& node, const std::string& path,
                     const std::vector<std::string_view>& words);
  void report_unknown_keys();

  const toml::table& table_;
  std::string path_, name_;
  ReadContext& context_;
  std::vector<std::string> known_keys_;  // copies: a method from outside may be gone when they are listed
  bool accepts_any_key_ = false;
};

template <typename T>
void TableReader::read(std::string_view key, T& value, const Choices<T>& choices) {
  const toml::node* node = find(key);
  if (!node) return;
  std::vector<std::string_view> words;
  for (const auto& choice : choices) words.push_back(choice.first);
  const std::size_t index = choose(*node, path_of(key), words);
  if (index < choices.size()) value = choices[index].second;
}

}  // namespace mica::host
