#pragma once

#include "host/methods/registry.h"

namespace mica::host::app {

/// `run_command` as the whole program of a process: its streams, its log and its signals are made ready
/// first. Call it once. @param methods by default those that are built in. @return the exit code.
int run_program(int argc, const char* const* argv);
int run_program(int argc, const char* const* argv, const MethodRegistry& methods);

}  // namespace mica::host::app
