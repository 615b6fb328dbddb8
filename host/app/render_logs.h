#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace mica::host::app {

/// What logs tell of a frame: the latest of it.
struct LoggedFrame {
  enum class State { waiting, rendering, failed, finished };

  State state = State::waiting;
  std::string time;    ///< of the last event, UTC
  std::string note;    ///< "device: ...", "45 of 120 rows"
  std::string place;   ///< "HOST, process 123"
  bool lives = false;  ///< the process that has it
  std::optional<double> seconds;
};

/// What logs tell of one output: "ocean.exr" of whatever folder.
struct LoggedSequence {
  std::string started;  ///< when the latest process began, UTC
  std::string job, hash, version;
  std::optional<std::pair<int, int>> range;  ///< first and last frame of the job; none: one picture
  std::map<int, LoggedFrame> frames;
};

/// Reads all logs of a folder and of those below it, `*.jsonl`; lines that are none of ours are left out.
/// @return by the output's name without folders.
std::map<std::string, LoggedSequence> read_logs(const std::string& folder);

}  // namespace mica::host::app
