#include "host/job/toml_settings.h"

namespace mica::host {
namespace {

Interval interval_of(const SettingRange& range) {
  return range.open_low ? open_low(range.low, range.high) : closed(range.low, range.high);
}

}  // namespace

void TomlSettings::number(const char* key, const char*, double& value, const SettingRange& range) {
  if (is_new(key)) table_.read(key, value, interval_of(range));
}

void TomlSettings::whole(const char* key, const char*, int& value, int low, int high) {
  if (is_new(key)) table_.read(key, value, closed(low, high));
}

void TomlSettings::seed(const char* key, const char*, std::uint32_t& value) {
  if (!is_new(key)) return;
  std::uint64_t seed = value;
  table_.read(key, seed);
  if (seed > 0xffffffffU) table_.report(key, "found more than 32 bits; expected a seed below 2^32");
  value = static_cast<std::uint32_t>(seed);
}

void TomlSettings::one_or_two(const char* key, const char*, Eigen::Vector2d& value,
                              const SettingRange& range) {
  if (is_new(key)) table_.read_one_or_two(key, value, interval_of(range));
}

void TomlSettings::word(const char* key, const char*, int& chosen, const std::vector<std::string>& words) {
  if (!is_new(key)) return;
  Choices<int> choices;
  for (std::size_t n = 0; n < words.size(); ++n) choices.emplace_back(words[n], static_cast<int>(n));
  table_.read(key, chosen, choices);
}

void TomlSettings::colors(const char* key, const char*, std::vector<Eigen::Vector3d>& values,
                          std::size_t most) {
  if (is_new(key)) table_.read(key, values, most, closed(0, 1));
}

void TomlSettings::file(const char* table, const char* key, const char*, std::string& value) {
  files_.push_back({table, key, &value});
}

void TomlSettings::read_files() {
  std::set<std::string> tables;
  for (const File& file : files_) tables.insert(file.table);
  for (const std::string& name : tables)
    table_.read_table(name, [&](TableReader& table) {
      for (const File& file : files_)
        if (file.table == name) table.read_file(file.key, *file.value);
    });
}

}  // namespace mica::host
