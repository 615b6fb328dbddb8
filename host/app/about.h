#pragma once

#include <string>

namespace mica::host::app {

/// The line of `mica --version`: "mica 0.2.0 (commit abcdef1, g++ 12.2.0; ...)", with the OpenCL platforms
/// that there are. Never throws: it is what one asks when OpenCL does not work.
std::string about();

/// Short hash of the commit that the build folder was configured from; "unknown" outside a repository.
const char* commit();

}  // namespace mica::host::app
