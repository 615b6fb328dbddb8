#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>

namespace mica::host {

/// A folder of this process, which goes with everything in it when the process ends.
class ProcessFolder {
 public:
  ProcessFolder()
      : path_(std::filesystem::path(testing::TempDir()) / ("mica_" + std::to_string(getpid()) + "_files")) {
    std::filesystem::create_directories(path_);
  }
  ~ProcessFolder() { std::filesystem::remove_all(path_); }
  ProcessFolder(const ProcessFolder&) = delete;
  ProcessFolder& operator=(const ProcessFolder&) = delete;

  std::string operator/(const std::string& file) const { return (path_ / file).string(); }

 private:
  std::filesystem::path path_;
};

/// Where a test may write a file: tests that run at the same time do not share it.
inline std::string temporary_path(const std::string& file) {
  static const ProcessFolder folder;
  return folder / file;
}

}  // namespace mica::host
