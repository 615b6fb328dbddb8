#pragma once

#include "mica/error.h"

namespace mica::host::app {

/// Exit codes of the command line; part of its contract.
enum class ExitCode { done = 0, some_images_failed = 1, usage = 2, device = 3, file = 4, interrupted = 130 };

inline ExitCode exit_code_of(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::usage:
      return ExitCode::usage;
    case ErrorKind::file:
      return ExitCode::file;
    case ErrorKind::cancelled:
      return ExitCode::interrupted;
    case ErrorKind::device:
      break;
  }
  return ExitCode::device;
}

}  // namespace mica::host::app
