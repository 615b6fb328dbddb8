#pragma once

#include <toml++/toml.h>
#include <string>
#include <string_view>
#include <vector>

#include "host/base/printable.h"
#include "host/job/job.h"

namespace mica::host {

/// Collects what is wrong with one job until all of it can be reported at once.
class Issues {
 public:
  explicit Issues(std::string job_path) : job_path_(std::move(job_path)) {}

  /// @param where its path tells the job file from an override, whose lines and columns would help nobody.
  void add(const toml::source_region& where, std::string message);

  bool empty() const { return issues_.empty(); }

  /// Throws JobError when there is any issue.
  void throw_if_any() const;

 private:
  std::string job_path_;
  std::vector<JobIssue> issues_;
};

/// `text` shortened, in quotes.
std::string in_quotes(std::string_view text);

/// "a, b, c"
std::string joined(const std::vector<std::string_view>& words);

/// ` (did you mean "width"?)` when a candidate is close to `word`, otherwise nothing.
std::string did_you_mean(std::string_view word, const std::vector<std::string_view>& candidates);

}  // namespace mica::host
