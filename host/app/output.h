#pragma once

#include <list>
#include <string>
#include <vector>

#include "host/base/leftovers.h"

namespace mica::host::app {

/// The files that a command is going to write, looked at before it works: hold it until they are written.
class Outputs {
 public:
  /// Makes the folders of files, which go again while they are empty.
  /// @param paths empty ones are left out. @param inputs that the command reads.
  /// Throws FileError for what cannot be written, UsageError for an output that is an input or another
  /// output.
  /// @param later outputs of frames after the first, which may fail for themselves: none may be an input.
  explicit Outputs(const std::vector<std::string>& paths, const std::vector<std::string>& inputs = {},
                   const std::vector<std::string>& later = {});

 private:
  void make_folder(const std::string& path);
  static void check_identities(const std::vector<std::string>& paths, const std::vector<std::string>& inputs);

  std::list<Leftover> folders_;  // the inner ones first, as they go
};

}  // namespace mica::host::app
