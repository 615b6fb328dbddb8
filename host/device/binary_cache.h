#pragma once

#include <string>

#include "host/device/device.h"

namespace mica::host {

/// Program binaries on disk, one file for each (source, options, device, driver), in $XDG_CACHE_HOME/mica or
/// ~/.cache/mica, which is the user's alone. A binary is loaded only when its length and hash are those that
/// were stored. A cache that cannot be read or written is no error: the program is built from source.
class BinaryCache {
 public:
  BinaryCache(const DeviceInfo& info, const std::string& source, const std::string& options);

  /// True when a usable binary was found; `program` is then built.
  bool load(const cl::Context& context, const cl::Device& device, cl::Program* program) const;
  void store(const cl::Program& program) const;
  const std::string& path() const { return path_; }

 private:
  std::string options_;
  std::string path_;  // empty: no folder to cache in
};

}  // namespace mica::host
