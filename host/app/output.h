#pragma once

#include <string>

namespace mica::host::app {

/// Makes the folder of `path` when it is missing, and throws FileError unless a file can be written there:
/// asked before hours of work, not after.
void prepare_output(const std::string& path);

}  // namespace mica::host::app
