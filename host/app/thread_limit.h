#pragma once

#include <memory>

namespace mica::host::app {

/// While it lives the host's threads and those of a CPU's OpenCL driver are as many as the process may use:
/// `usable_processors`. Made before a driver is asked for its devices. With MICA_CACHE_DIR the driver's own
/// cache is below that folder. What the user says to the driver himself counts more.
class ThreadLimit {
 public:
  ThreadLimit();
  ~ThreadLimit();

 private:
  class Control;
  std::unique_ptr<Control> control_;
};

}  // namespace mica::host::app
