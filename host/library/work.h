#pragma once

#include <algorithm>
#include <cstddef>

#include "host/base/stopwatch.h"
#include "mica/control.h"
#include "mica/error.h"

namespace mica::host {

/// Calls `work(first, count)` for successive chunks of 0 .. count - 1, each of about half a second, between
/// which it reports progress and looks whether the caller cancelled.
template <typename Work>
void work_in_chunks(std::size_t count, const RunControl& control, const Work& work) {
  constexpr std::size_t largest = std::size_t{1} << 20;  // also bounds the host's memory
  std::size_t chunk = 4096;
  for (std::size_t first = 0; first < count;) {
    if (control.cancellation.is_cancelled()) throw Cancelled();
    const Stopwatch watch;
    const std::size_t some = std::min(chunk, count - first);
    work(first, some);
    first += some;
    if (control.progress) control.progress(first, count);
    if (watch.seconds() < 0.25) chunk = std::min(2 * chunk, largest);
    if (watch.seconds() > 1) chunk = std::max<std::size_t>(chunk / 2, 1);
  }
  if (control.cancellation.is_cancelled()) throw Cancelled();
}

}  // namespace mica::host
