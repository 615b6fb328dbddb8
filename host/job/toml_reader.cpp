#include "host/job/toml_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "host/job/toml_document.h"

namespace mica::host {
namespace {

std::string to_string(const Interval& range) {
  return fmt::format("in {}{}, {}{}", range.open_low ? '(' : '[', range.low, range.high,
                     range.open_high ? ')' : ']');
}

std::string one_of(const std::vector<std::string_view>& words) {
  return words.size() == 1 ? in_quotes(words[0]) : "one of: " + joined(words);
}

bool is_bare_key(std::string_view key) {
  return !key.empty() && std::all_of(key.begin(), key.end(),
                                     [](unsigned char c) { return std::isalnum(c) || c == '_' || c == '-'; });
}

}  // namespace

bool Interval::contains(double x) const {
  return (open_low ? x > low : x >= low) && (open_high ? x < high : x <= high);
}

TableReader::TableReader(const toml::table& table, std::string path, std::string name, ReadContext& context)
    : table_(table), path_(std::move(path)), name_(std::move(name)), context_(context) {}

void TableReader::read_root(const toml::table& root, ReadContext& context, const Visitor& visit) {
  TableReader(root, "", "", context).visit(visit);
}

void TableReader::visit(const Visitor& visitor) {
  visitor(*this);
  if (!accepts_any_key_) report_unknown_keys();
}

void TableReader::visit_child(const toml::node& child, const std::string& path, const std::string& name,
                              const Visitor& visitor) {
  if (const toml::table* table = child.as_table()) {
    TableReader(*table, path, name, context_).visit(visitor);
  } else {
    report_unexpected(child, path, "a table");
  }
}

const toml::node* TableReader::find(std::string_view key) {
  if (std::find(known_keys_.begin(), known_keys_.end(), key) == known_keys_.end())
    known_keys_.emplace_back(key);
  return table_.get(key);
}

std::string TableReader::path_of(std::string_view key) const {
  const std::string shown = is_bare_key(key) ? std::string(key) : in_quotes(key);
  return path_.empty() ? shown : path_ + '.' + shown;
}

void TableReader::report_at(const toml::node& node, const std::string& path, std::string_view message) {
  context_.issues.add(node.source(),
                      path.empty() ? std::string(message) : fmt::format("{}: {}", path, message));
}

void TableReader::report(std::string_view message) {
  report_at(table_, path_, message);
}

void TableReader::report(std::string_view key, std::string_view message) {
  if (const toml::node* node = table_.get(key)) return report_at(*node, path_of(key), message);
  report(message);
}

void TableReader::report_unexpected(const toml::node& node, const std::string& path,
                                    std::string_view expected) {
  report_at(node, path, fmt::format("found {}; expected {}", describe(node), expected));
}

void TableReader::report_unknown_keys() {
  const std::vector<std::string_view> known(known_keys_.begin(), known_keys_.end());
  for (const auto& [key, node] : table_) {
    const std::string_view word = key.str();
    if (std::find(known.begin(), known.end(), word) != known.end()) continue;
    context_.issues.add(key.source(), fmt::format("{}: found an unknown key; expected {}{}", path_of(word),
                                                  one_of(known), did_you_mean(word, known)));
  }
}

bool TableReader::require(std::string_view key, std::string_view expected) {
  if (find(key)) return true;
  report(fmt::format("found no key \"{}\"; expected {}", key, expected));
  return false;
}

void TableReader::read(std::string_view key, int& value, const Interval& range) {
  const toml::node* node = find(key);
  if (!node) return;
  const auto* integer = node->as_integer();
  if (integer && range.contains(double(integer->get()))) {
    value = int(integer->get());
  } else {
    report_unexpected(*node, path_of(key), "an integer " + to_string(range));
  }
}

void TableReader::read(std::string_view key, std::uint64_t& value) {
  const toml::node* node = find(key);
  if (!node) return;
  const auto* integer = node->as_integer();
  if (integer && integer->get() >= 0) {
    value = std::uint64_t(integer->get());
  } else {
    report_unexpected(*node, path_of(key), "an integer from 0 below 2^63");
  }
}

bool TableReader::read_number(const toml::node& node, const std::string& path, double& value,
                              const Interval& range) {
  const std::optional<double> number = node.value<double>();
  if (number && range.contains(*number)) {
    value = *number;
    return true;
  }
  report_unexpected(node, path, "a number " + to_string(range));
  return false;
}

void TableReader::read(std::string_view key, double& value, const Interval& range) {
  if (const toml::node* node = find(key)) read_number(*node, path_of(key), value, range);
}

void TableReader::read_numbers(std::string_view key, double* values, std::size_t count,
                               const Interval& range) {
  if (const toml::node* node = find(key)) read_numbers(*node, path_of(key), values, count, range);
}

void TableReader::read_numbers(const toml::node& node, const std::string& path, double* values,
                               std::size_t count, const Interval& range) {
  const toml::array* array = node.as_array();
  if (!array || array->size() != count) {
    const std::string found = array ? fmt::format("an array of {}", array->size()) : describe(node);
    report_at(node, path,
              fmt::format("found {}; expected an array of {} numbers {}", found, count, to_string(range)));
    return;
  }
  std::vector<double> numbers(count);
  bool valid = true;
  for (std::size_t i = 0; i < count; ++i) {
    valid &= read_number((*array)[i], fmt::format("{}.{}", path, i), numbers[i], range);
  }
  if (valid) std::copy(numbers.begin(), numbers.end(), values);
}

void TableReader::read_one_or_two(std::string_view key, Eigen::Vector2d& value, const Interval& range) {
  const toml::node* node = find(key);
  if (!node) return;
  double number = 0;
  if (node->is_array()) {
    read_numbers(*node, path_of(key), value.data(), 2, range);
  } else if (read_number(*node, path_of(key), number, range)) {
    value.setConstant(number);
  }
}

void TableReader::read(std::string_view key, std::vector<Eigen::Vector3d>& values, std::size_t most,
                       const Interval& range) {
  const toml::node* node = find(key);
  if (!node) return;
  const toml::array* array = node->as_array();
  if (!array || array->empty() || array->size() > most) {
    const std::string found = array ? fmt::format("an array of {}", array->size()) : describe(*node);
    return report(key,
                  fmt::format("found {}; expected an array of 1 to {} arrays of 3 numbers", found, most));
  }
  values.assign(array->size(), Eigen::Vector3d::Zero());
  for (std::size_t i = 0; i < array->size(); ++i)
    read_numbers((*array)[i], fmt::format("{}.{}", path_of(key), i), values[i].data(), 3, range);
}

const std::string* TableReader::find_text(std::string_view key) {
  const toml::node* node = find(key);
  if (!node) return nullptr;
  const auto* text = node->as_string();
  if (text && !text->get().empty()) return &text->get();
  report_unexpected(*node, path_of(key), "a string that is not empty");
  return nullptr;
}

void TableReader::read(std::string_view key, std::string& value) {
  if (const std::string* text = find_text(key)) value = *text;
}

std::size_t TableReader::choose(const toml::node& node, const std::string& path,
                                const std::vector<std::string_view>& words) {
  const auto* text = node.as_string();
  const auto word = text ? std::find(words.begin(), words.end(), text->get()) : words.end();
  if (word == words.end()) {
    report_unexpected(node, path, one_of(words) + (text ? did_you_mean(text->get(), words) : ""));
  }
  return std::size_t(word - words.begin());
}

void TableReader::read(std::string_view key, std::vector<std::string>& values,
                       const std::vector<std::string_view>& choices) {
  const toml::node* node = find(key);
  if (!node) return;
  const toml::array* array = node->as_array();
  if (!array) return report_unexpected(*node, path_of(key), "an array with any of: " + joined(choices));
  values.clear();
  for (std::size_t i = 0; i < array->size(); ++i) {
    const std::string path = fmt::format("{}.{}", path_of(key), i);
    const toml::node& element = (*array)[i];
    const std::size_t index = choose(element, path, choices);
    if (index == choices.size()) continue;
    if (std::find(values.begin(), values.end(), choices[index]) != values.end()) {
      report_at(element, path,
                fmt::format("found {} again; expected each at most once", in_quotes(choices[index])));
    } else {
      values.emplace_back(choices[index]);
    }
  }
}

void TableReader::read_reference(std::string_view key, std::string& value, std::string_view kind,
                                 const std::vector<std::string_view>& names) {
  const std::string* text = find_text(key);
  if (!text) return;
  if (std::find(names.begin(), names.end(), *text) != names.end()) {
    value = *text;
  } else if (names.empty()) {
    report(key, fmt::format("found {}; expected a table [{}.NAME] of that name, and there is none",
                            in_quotes(*text), kind));
  } else {
    report(key, fmt::format("found {}; expected the name of a {}, {}{}", in_quotes(*text), kind,
                            one_of(names), did_you_mean(*text, names)));
  }
}

void TableReader::read_file(std::string_view key, std::string& path) {
  const std::string* text = find_text(key);
  if (!text) return;
  const std::filesystem::path file = context_.folder / *text;
  std::error_code ignored;
  const auto status = std::filesystem::status(file, ignored);
  if (std::filesystem::is_directory(status)) {
    report(key, fmt::format("found the folder {}; expected a file", in_quotes(file.string())));
  } else if (!std::filesystem::exists(status)) {
    report(key, fmt::format("found no file {}; expected one, relative to the job's folder",
                            in_quotes(file.string())));
  } else {
    path = file.string();
  }
}

void TableReader::read_choice(PictureChoice& choice) {
  choice.max_bytes = context_.max_bytes;
  read("part", choice.part);
  read("channels", choice.channels);
}

void TableReader::read_table(std::string_view key, const Visitor& visit) {
  if (const toml::node* node = find(key)) visit_child(*node, path_of(key), std::string(key), visit);
}

void TableReader::read_named_tables(std::string_view key, const Visitor& visit) {
  read_table(key, [&](TableReader& tables) {
    tables.accept_any_key();
    for (const auto& [name, node] : tables.table_) {
      const std::string path = tables.path_of(name.str());
      if (name.str().empty()) {
        report_at(node, path, "found an empty name; expected one that can be referred to");
      } else if (!node.is_table()) {
        report_unexpected(node, path, fmt::format("a table, headed [{}.NAME]", key));
      } else {
        visit_child(node, path, std::string(name.str()), visit);
      }
    }
  });
}

void TableReader::read_table_array(std::string_view key, const Visitor& visit) {
  const toml::node* node = find(key);
  const toml::array* array = node ? node->as_array() : nullptr;
  if (node && !array) {
    return report_unexpected(*node, path_of(key), fmt::format("an array of tables, each headed [[{}]]", key));
  }
  if (!array || array->empty()) {
    return report(key, fmt::format("found no [[{}]]; expected at least one", key));
  }
  for (std::size_t i = 0; i < array->size(); ++i) {
    visit_child((*array)[i], fmt::format("{}.{}", path_of(key), i), std::string(key), visit);
  }
}

}  // namespace mica::host
