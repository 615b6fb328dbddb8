#pragma once

#include <cstdint>
#include <string>

#include "host/device/device.h"

namespace mica::host {

/// Program binaries on disk, one file for each (source, options, device, driver), in $MICA_CACHE_DIR,
/// $XDG_CACHE_HOME/mica or ~/.cache/mica, which is the user's alone. A binary is loaded only when its length
/// and hash are those that were stored. A cache that cannot be read or written is no error: the program is
/// built from source.
class BinaryCache {
 public:
  BinaryCache(const DeviceInfo& info, const std::string& source, const std::string& options);

  /// True when a usable binary was found; `program` is then built.
  bool load(const cl::Context& context, const cl::Device& device, cl::Program* program) const;
  void store(const cl::Program& program) const;

  /// While it lives no other process, on any machine, compiles this program, if the file system has locks.
  class Turn {
   public:
    explicit Turn(int descriptor) : descriptor_(descriptor) {}
    ~Turn();
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;

   private:
    int descriptor_;  // -1: there is nothing to lock
  };
  /// Waits for others that compile this program: then it may be there. Not for ever: a machine that hangs
  /// must not hold up all others. Throws Interrupted.
  Turn wait_for_turn() const;

  const std::string& path() const { return path_; }

 private:
  std::string options_;
  std::string path_;  // empty: no folder to cache in
  std::uint64_t key_ = 0;
};

}  // namespace mica::host
