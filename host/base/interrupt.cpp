#include "host/base/interrupt.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <thread>

#include "host/base/leftovers.h"

namespace mica::host {
namespace {

volatile std::sig_atomic_t received = 0;  // a signal handler can reach nothing else
int wake[2] = {-1, -1};

void remember(int signal) {
  const int before = errno;
  received = signal;
  // More of them change nothing (a scheduler, or `timeout`, sends two at once): the first ends the process
  // within a second, and the default action would leave what is unfinished. Without the thread that sees to
  // it, there is the default action alone.
  if (wake[1] < 0) std::signal(signal, SIG_DFL);
  const char byte = 0;
  static_cast<void>(!write(wake[1], &byte, 1));
  errno = before;
}

/// Work that looks for signals unwinds in time. What does not (a driver compiles, a file is decoded) is ended
/// here.
void end_what_does_not_unwind() {
  char byte = 0;
  while (read(wake[0], &byte, 1) < 0 && errno == EINTR) {
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(600));
  remove_leftovers();
  constexpr char message[] = "mica: stopped by a signal; nothing unfinished was written\n";
  static_cast<void>(!write(STDERR_FILENO, message, sizeof message - 1));
  _exit(128 + received);
}

}  // namespace

void catch_interrupts() {
  if (pipe2(wake, O_CLOEXEC) == 0) std::thread(end_what_does_not_unwind).detach();
  std::signal(SIGINT, remember);
  std::signal(SIGTERM, remember);
}

void check_interrupt() {
  if (received) throw Interrupted(received);
}

}  // namespace mica::host
