#pragma once

namespace mica::host {

/// Thrown by `check_interrupt` after SIGINT or SIGTERM; unwinding removes temporary files.
class Interrupted {
 public:
  explicit Interrupted(int signal) : signal_(signal) {}
  int signal() const { return signal_; }

 private:
  int signal_;
};

/// From now on SIGINT and SIGTERM are remembered, and end the process within a second, also where nothing
/// looks for them: by 128 and the signal, without leftovers. A second one ends it at once.
void catch_interrupts();

/// Throws Interrupted when one has come. Long work calls it between batches.
void check_interrupt();

}  // namespace mica::host
