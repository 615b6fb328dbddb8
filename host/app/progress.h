#pragma once

#include <chrono>
#include <string>

namespace mica::host::app {

/// Progress on stderr: a bar with rate and time left on a terminal, a plain line every tenth elsewhere.
class Progress {
 public:
  /// @param unit what is counted, e.g. "rows"; @param quiet shows nothing.
  Progress(std::string unit, bool quiet);
  void update(long done, long all);

 private:
  std::string unit_;
  bool quiet_, terminal_;
  long tenths_ = 0;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace mica::host::app
