#include "host/base/interrupt.h"

#include <csignal>

namespace mica::host {
namespace {

volatile std::sig_atomic_t received = 0;  // a signal handler can reach nothing else

void remember(int signal) {
  received = signal;
  std::signal(signal, SIG_DFL);
}

}  // namespace

void catch_interrupts() {
  std::signal(SIGINT, remember);
  std::signal(SIGTERM, remember);
}

void check_interrupt() {
  if (received) throw Interrupted(received);
}

}  // namespace mica::host
