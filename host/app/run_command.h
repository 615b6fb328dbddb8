#pragma once

#include "host/methods/registry.h"

namespace mica::host::app {

/// The command line with the methods of a registry: parses, runs, prints what went wrong. @return the exit
/// code.
int run_command(int argc, const char* const* argv, const MethodRegistry& methods);

}  // namespace mica::host::app
