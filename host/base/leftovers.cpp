#include "host/base/leftovers.h"

#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <mutex>
#include <set>
#include <utility>

namespace mica::host {
namespace {

namespace fs = std::filesystem;

// The watch over signals has to find them, wherever the work is that made them.
struct Leftovers {
  std::mutex mutex;
  std::set<std::string> paths;
};

Leftovers& leftovers() {
  static auto* const all = new Leftovers;  // outlives whatever ends while the process does
  return *all;
}

}  // namespace

std::string host_name() {
  std::array<char, 256> name{};
  if (gethostname(name.data(), name.size() - 1) != 0) return "host";
  const std::string text(name.data());
  return text.substr(0, 64);
}

namespace {

std::string prefix() {
  return ".mica-" + host_name() + "-";
}

}  // namespace

Leftover::Leftover(std::string path) : path_(std::move(path)) {
  const std::lock_guard<std::mutex> lock(leftovers().mutex);
  leftovers().paths.insert(path_);
}

Leftover::~Leftover() {
  if (path_.empty()) return;
  std::remove(path_.c_str());
  keep();
}

void Leftover::keep() {
  const std::lock_guard<std::mutex> lock(leftovers().mutex);
  leftovers().paths.erase(path_);
  path_.clear();
}

void remove_leftovers() noexcept {
  const std::lock_guard<std::mutex> lock(leftovers().mutex);
  auto& paths = leftovers().paths;
  for (auto path = paths.rbegin(); path != paths.rend(); ++path)
    std::remove(path->c_str());  // files before folders
}

std::string temporary_name(const std::string& target, int number) {
  const std::string name = fmt::format("{}{}-{}.tmp", prefix(), getpid(), number);
  return (fs::path(target).parent_path() / name).string();
}

void remove_stale_temporaries(const std::string& folder) noexcept {
  std::error_code error;
  const std::string mine = prefix();
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name.compare(0, mine.size(), mine) != 0) continue;
    int process = 0;
    std::from_chars(name.data() + mine.size(), name.data() + name.size(), process);
    if (process > 0 && kill(process, 0) != 0 && errno == ESRCH) std::remove(entry->path().c_str());
  }
}

}  // namespace mica::host
