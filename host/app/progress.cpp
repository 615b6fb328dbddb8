#include "host/app/progress.h"
#include "host/app/say.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <utility>

namespace mica::host::app {

Progress::Progress(std::string unit, bool quiet)
    : unit_(std::move(unit)),
      quiet_(quiet),
      terminal_(isatty(STDERR_FILENO) != 0),
      start_(std::chrono::steady_clock::now()) {}

void Progress::update(long done, long all) {
  if (quiet_ || all <= 0) return;
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  const double rate = seconds > 0 ? static_cast<double>(done) / seconds : 0;
  const double left = rate > 0 ? static_cast<double>(all - done) / rate : 0;
  const std::string text =
      fmt::format("{} of {} {}, {:.0f} {}/s, {:.1f} s left", done, all, unit_, rate, unit_, left);
  if (terminal_) {
    constexpr long width = 30;
    const long filled = width * done / all;
    say("\r[{}{}] {}\033[K{}", std::string(filled, '='), std::string(width - filled, ' '), text,
        done == all ? "\n" : "");
  } else if (const long tenths = 10 * done / all; tenths > tenths_) {
    tenths_ = tenths;
    say("{}\n", text);
  }
}

}  // namespace mica::host::app
