#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>  // mkdtemp

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "host/job/job.h"

namespace mica::host::test {

/// A folder of its own for one test, with a job file in it.
class JobFolder {
 public:
  JobFolder() {
    std::string name = testing::TempDir() + "mica_job_XXXXXX";
    EXPECT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  ~JobFolder() { std::filesystem::remove_all(folder_); }
  JobFolder(const JobFolder&) = delete;
  JobFolder& operator=(const JobFolder&) = delete;

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }

  /// Loads `text` as the job file "job.toml" of this folder.
  Job load(const std::string& text, const std::vector<std::string>& overrides = {}) const {
    write("job.toml", text);
    return load_job(path("job.toml"), overrides);
  }

  /// The issues of `text`; none when it loads.
  std::vector<JobIssue> issues(const std::string& text,
                               const std::vector<std::string>& overrides = {}) const {
    try {
      load(text, overrides);
      return {};
    } catch (const JobError& error) {
      return error.issues();
    }
  }

 private:
  std::filesystem::path folder_;
};

/// A job with nothing but what every job needs.
inline const std::string kLeastJob = R"(
[surface.bumps]
generate = "spectrum"

[material.gold]
surface = "bumps"

[[shape]]
type = "sphere"
material = "gold"

[[light]]
type = "point"
position = [0, 0, 4]
)";

/// `text` with its first `from` replaced; with an empty `from`, `to` comes in front.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

}  // namespace mica::host::test
