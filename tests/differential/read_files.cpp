// What Mica's parsers read in files, for other parsers of the same formats to be set against. Names of files
// come line by line on standard input; a line of JSON each goes out: {"rows": ..} of a .npy or .csv, {"toml":
// ..} of a .toml, where numbers are exact, or {"refused": why}.
#include <fmt/format.h>

#include <fstream>
#include <iostream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "host/job/toml_document.h"
#include "host/tables/table.h"
#include "mica/error.h"

namespace mica::host {
namespace {

using nlohmann::json;

/// C's hexadecimal form, which Python reads as well.
std::string exact(double value) {
  return fmt::format("{:a}", value);
}

bool ends_with(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

json rows_of(const std::string& path) {
  std::unique_ptr<RowSource> rows;
  if (ends_with(path, ".npy"))
    rows = open_npy(path);
  else
    rows = std::make_unique<TableRows>(read_csv(path, {{"u", "v", "s"}, {{"t"}}, {}}));
  json list = json::array();
  for (std::size_t n = 0; n < rows->rows(); ++n) {
    json row = json::array();
    for (const double value : rows->read(n, 1)) row.push_back(exact(value));
    list.push_back(row);
  }
  return {{"rows", list}};
}

json to_json(const toml::node& node) {
  if (const auto* table = node.as_table()) {
    json object = json::object();
    for (const auto& [key, value] : *table) object[std::string(key.str())] = to_json(value);
    return object;
  }
  if (const auto* array = node.as_array()) {
    json list = json::array();
    for (const toml::node& value : *array) list.push_back(to_json(value));
    return list;
  }
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* integer = node.as_integer()) return integer->get();
  if (const auto* number = node.as_floating_point()) return {{"float", exact(number->get())}};
  if (const auto* flag = node.as_boolean()) return flag->get();
  return {{"date", true}};
}

json toml_of(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  return {{"toml", to_json(parse_toml(text, path))}};
}

json read(const std::string& path) {
  try {
    return ends_with(path, ".toml") ? toml_of(path) : rows_of(path);
  } catch (const Error& error) {
    return {{"refused", error.what()}};
  } catch (const toml::parse_error& error) {
    return {{"refused", std::string(error.description())}};
  }
}

}  // namespace
}  // namespace mica::host

int main() {
  for (std::string path; std::getline(std::cin, path);)
    std::cout << mica::host::read(path).dump(-1, ' ', true, nlohmann::json::error_handler_t::replace) << '\n';
}
