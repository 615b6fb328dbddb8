#pragma once

#include <condition_variable>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "mica/error.h"

namespace mica::host::app {

/// `--json-log FILE`: what happens, one JSON object a line, each written at once at the file's end. Several
/// processes may share a file. docs/farm.md lists the events.
class JsonLog {
 public:
  /// @param path empty: nothing is written. What is there is kept. Throws FileError when it cannot be opened
  /// or holds something else than such a log.
  explicit JsonLog(const std::string& path);
  ~JsonLog();
  JsonLog(const JsonLog&) = delete;
  JsonLog& operator=(const JsonLog&) = delete;

  /// Adds time, host and process to `details`. A log that is full does not end the work that it tells of.
  void write(const std::string& event, const nlohmann::json& details = nlohmann::json::object());

 private:
  void say_alive();

  int descriptor_ = -1;
  std::mutex mutex_;
  std::condition_variable ended_;
  bool is_ending_ = false;
  std::thread alive_;  // so that whoever reads the log can tell long work from a lost machine
};

/// "usage", "device", "file" or "cancelled".
std::string word_of_kind(ErrorKind kind);

}  // namespace mica::host::app
