#pragma once

#include <set>
#include <string>

#include "host/job/toml_reader.h"
#include "host/methods/settings.h"

namespace mica::host {

/// Reads a method's settings from a table of a job.
class TomlSettings : public SettingVisitor {
 public:
  explicit TomlSettings(TableReader& table) : table_(table) {}
  SettingSource source() const override { return SettingSource::job; }

  void number(const char* key, const char* help, double& value, const SettingRange& range) override;
  void whole(const char* key, const char* help, int& value, int low, int high) override;
  void seed(const char* key, const char* help, std::uint32_t& value) override;
  void one_or_two(const char* key, const char* help, Eigen::Vector2d& value,
                  const SettingRange& range) override;
  void word(const char* key, const char* help, int& chosen, const std::vector<std::string>& words) override;
  void colors(const char* key, const char* help, std::vector<Eigen::Vector3d>& values,
              std::size_t most) override;
  void file(const char* table, const char* key, const char* help, std::string& value) override;

  /// Reads the files, whose tables are asked for once. Call after the last visit.
  void read_files();

 private:
  struct File {
    std::string table, key;
    std::string* value;
  };
  bool is_new(const char* key) { return read_.insert(key).second; }

  TableReader& table_;
  std::set<std::string> read_;  // keys: two methods may have the same one
  std::vector<File> files_;
};

}  // namespace mica::host
