#pragma once

#include <cstddef>

#include "mica/control.h"
#include "mica/error.h"

namespace mica::host {

/// Between two pieces of work: throws Cancelled where the caller said so, and reports what is done.
inline void report(const RunControl& control, std::size_t done, std::size_t all) {
  if (control.cancellation.is_cancelled()) throw Cancelled();
  if (control.progress && done > 0) control.progress(done, all);
  if (control.cancellation.is_cancelled()) throw Cancelled();
}

}  // namespace mica::host
