#include "host/base/processors.h"

#include <sched.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string_view>
#include <thread>

namespace mica::host {
namespace {

namespace fs = std::filesystem;

/// Processors that the file of a control group allows; 0: it says nothing.
double quota_of(const fs::path& group) {
  double quota = 0, period = 0;
  if (std::ifstream both(group / "cpu.max"); both >> quota >> period)  // "max" is no number
    return period > 0 ? quota / period : 0;
  std::ifstream first(group / "cpu.cfs_quota_us"), second(group / "cpu.cfs_period_us");
  if (first >> quota && second >> period && quota > 0 && period > 0) return quota / period;
  return 0;
}

int processors_by_affinity() {
  cpu_set_t set;
  if (sched_getaffinity(0, sizeof set, &set) == 0) return CPU_COUNT(&set);
  return static_cast<int>(std::thread::hardware_concurrency());  // more of them than a cpu_set_t has
}

int number_of_variable(const char* name) {
  const char* text = std::getenv(name);
  int number = 0;
  if (text) std::from_chars(text, text + std::string_view(text).size(), number);
  return std::max(number, 0);
}

}  // namespace

double processor_quota(const std::string& memberships, const std::string& root) {
  double least = 0;
  std::istringstream lines(memberships);
  for (std::string line; std::getline(lines, line);) {  // "0::/a/b", or "4:cpu,cpuacct:/a/b" of version 1
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (second == line.npos) continue;
    const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",";
    const bool is_second = controllers == ",,";
    if (!is_second && controllers.find(",cpu,") == controllers.npos) continue;
    const fs::path mount = is_second ? fs::path(root) : fs::path(root) / "cpu";
    // In a container the path may be that outside it: what is above it is asked as well.
    for (fs::path group = line.substr(second + 1);; group = group.parent_path()) {
      const double quota = quota_of(mount / group.relative_path());
      if (quota > 0 && (least == 0 || quota < least)) least = quota;
      if (!group.has_relative_path()) break;
    }
  }
  return least;
}

int usable_processors() {
  int count = processors_by_affinity();
  std::ostringstream memberships;
  memberships << std::ifstream("/proc/self/cgroup").rdbuf();
  if (const double quota = processor_quota(memberships.str(), "/sys/fs/cgroup"); quota > 0)
    count = std::min(count, static_cast<int>(std::ceil(quota)));
  const int of_task = number_of_variable("SLURM_CPUS_PER_TASK");
  const int of_job = of_task > 0 ? of_task : number_of_variable("SLURM_CPUS_ON_NODE");
  if (of_job > 0) count = std::min(count, of_job);
  return std::max(count, 1);
}

}  // namespace mica::host
