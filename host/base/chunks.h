#pragma once

#include <algorithm>
#include <cstddef>

#include "host/base/stopwatch.h"

namespace mica::host {

/// Calls `work(first, count)` for successive chunks of 0 .. count - 1, each of about a second. Before each,
/// and at the end, `between(done)` may report progress, and may throw to stop.
template <typename Work, typename Between>
void work_in_chunks(std::size_t count, const Work& work, const Between& between) {
  constexpr std::size_t largest = std::size_t{1} << 20;  // also bounds the host's memory
  std::size_t chunk = 256;
  for (std::size_t first = 0; first < count;) {
    between(first);
    const Stopwatch watch;
    const std::size_t some = std::min(chunk, count - first);
    work(first, some);
    first += some;
    const double seconds = watch.seconds();
    if (seconds < 0.5) chunk = std::min(2 * chunk, largest);
    if (seconds > 2) chunk = std::max<std::size_t>(chunk / 2, 1);
  }
  between(count);
}

}  // namespace mica::host
