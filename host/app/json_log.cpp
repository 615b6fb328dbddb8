#include "host/app/json_log.h"

#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>

#include "host/base/leftovers.h"

namespace mica::host::app {
namespace {

constexpr std::chrono::seconds kAlive{20};

/// "2026-01-31T09:30:05.123Z"
std::string utc_now() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  const auto milliseconds = std::chrono::duration_cast<std::chrono::milliseconds>(now).count();
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z",
                     fmt::gmtime(static_cast<std::time_t>(milliseconds / 1000)), milliseconds % 1000);
}

/// A log that is named by mistake must not grow at the end of a job.
bool holds_something_else(int descriptor) {
  struct stat status;
  char first = 0;
  return fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode) && status.st_size > 0 &&
         pread(descriptor, &first, 1, 0) == 1 && first != '{';
}

}  // namespace

JsonLog::JsonLog(const std::string& path) {
  if (path.empty()) return;
  descriptor_ = open(path.c_str(), O_RDWR | O_APPEND | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor_ < 0) throw FileError(fmt::format("{}: cannot open: {}", path, std::strerror(errno)));
  if (holds_something_else(descriptor_)) {
    close(descriptor_);
    throw FileError(path + ": found something else; expected a log of JSON lines, or no file");
  }
  alive_ = std::thread([this] { say_alive(); });
}

JsonLog::~JsonLog() {
  if (descriptor_ < 0) return;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    is_ending_ = true;
  }
  ended_.notify_all();
  alive_.join();
  close(descriptor_);
}

void JsonLog::write(const std::string& event, const nlohmann::json& details) {
  if (descriptor_ < 0) return;
  nlohmann::ordered_json line = {
      {"time", utc_now()}, {"event", event}, {"host", host_name()}, {"process", getpid()}};
  for (const auto& [key, value] : details.items()) line[key] = value;
  const std::string text = line.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
  const std::lock_guard<std::mutex> lock(mutex_);
  static_cast<void>(!::write(descriptor_, text.data(), text.size()));  // one call: lines stay whole
}

void JsonLog::say_alive() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (!ended_.wait_for(lock, kAlive, [this] { return is_ending_; })) {
    lock.unlock();
    write("alive");
    lock.lock();
  }
}

std::string word_of_kind(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::usage:
      return "usage";
    case ErrorKind::file:
      return "file";
    case ErrorKind::cancelled:
      return "cancelled";
    case ErrorKind::device:
      break;
  }
  return "device";
}

}  // namespace mica::host::app
