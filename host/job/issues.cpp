#include "host/job/issues.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>
#include <utility>

namespace mica::host {
namespace {

std::string listing(const std::vector<JobIssue>& issues) {
  std::string text;
  for (const JobIssue& issue : issues) {
    if (!text.empty()) text += '\n';
    text += issue.line > 0 ? fmt::format("{}:{}:{}: {}", issue.file, issue.line, issue.column, issue.message)
                           : fmt::format("{}: {}", issue.file, issue.message);
  }
  return text;
}

/// Insertions, deletions, substitutions and swaps of neighbours that turn `a` into `b`: the optimal string
/// alignment distance.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before_last, last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before_last = std::exchange(last, row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] != b[j - 1])});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
  }
  return row[b.size()];
}

}  // namespace

JobError::JobError(std::vector<JobIssue> issues) : UsageError(listing(issues)), issues_(std::move(issues)) {}

void Issues::add(const toml::source_region& where, std::string message) {
  const std::string& file = where.path ? *where.path : job_path_;
  if (file == job_path_) {
    issues_.push_back({file, int(where.begin.line), int(where.begin.column), std::move(message)});
  } else {
    issues_.push_back({file, 0, 0, std::move(message)});
  }
}

void Issues::throw_if_any() const {
  if (issues_.empty()) return;
  std::vector<JobIssue> sorted = issues_;
  const auto order = [](const JobIssue& issue) {
    return std::make_tuple(issue.line == 0, issue.line, issue.column);
  };
  std::stable_sort(sorted.begin(), sorted.end(),
                   [&](const JobIssue& a, const JobIssue& b) { return order(a) < order(b); });
  throw JobError(std::move(sorted));
}

std::string in_quotes(std::string_view text) {
  return '"' + shortened(text) + '"';
}

std::string joined(const std::vector<std::string_view>& words) {
  return fmt::format("{}", fmt::join(words, ", "));
}

std::string did_you_mean(std::string_view word, const std::vector<std::string_view>& candidates) {
  if (word.size() > 64) return "";  // no slip of the hand
  const auto nearest = std::min_element(candidates.begin(), candidates.end(), [&](auto a, auto b) {
    return edit_distance(word, a) < edit_distance(word, b);
  });
  if (nearest == candidates.end()) return "";
  const std::size_t allowed = std::max<std::size_t>(1, nearest->size() / 3);
  return edit_distance(word, *nearest) <= allowed ? fmt::format(" (did you mean {}?)", in_quotes(*nearest))
                                                  : "";
}

}  // namespace mica::host
