#include "host/methods/pyramid/pyramid_store.h"

#include <algorithm>

#include "host/base/stopwatch.h"

namespace mica::host {

std::size_t pyramid_levels_bytes(int map_width, int map_height) {
  constexpr std::size_t bytes_a_texel = 22, least = std::size_t{16} << 20;
  return std::max(least, bytes_a_texel * map_width * map_height);
}

PyramidStore::PyramidStore(Device& device, const Surface& surface, std::size_t levels_bytes,
                           WaveForm wave_form, std::size_t batch_queries)
    : device_(device),
      surface_(surface),
      levels_bytes_(levels_bytes),
      wave_form_(wave_form),
      batch_queries_(batch_queries) {}

const PyramidLevels& PyramidStore::levels(double cell_width) {
  const auto found = levels_.find(cell_width);
  if (found != levels_.end()) return found->second;
  const Stopwatch watch;
  const PyramidLevels levels = levels_that_fit(surface_, cell_width, levels_bytes_);
  build_seconds_ += watch.seconds();
  return levels_[cell_width] = levels;
}

/// Coarser levels come with the one that is needed: together they take a third of it.
PyramidLevelBatches& PyramidStore::level(double cell_width, int block) {
  const auto found = built_.find({cell_width, block});
  if (found != built_.end()) return found->second;
  PyramidLevels needed = levels(cell_width);
  needed.finest_block = block;
  const Stopwatch watch;
  build_moment_pyramid(surface_, needed, [&](int built_block, const PyramidLevel& level) {
    built_.try_emplace({cell_width, built_block}, device_, level, wave_form_, batch_queries_);
  });
  build_seconds_ += watch.seconds();
  return built_.at({cell_width, block});
}

void PyramidStore::keep(const std::set<double>& cell_widths) {
  for (auto level = built_.begin(); level != built_.end();) {
    if (cell_widths.count(level->first.first) != 0) {
      ++level;
      continue;
    }
    dropped_device_seconds_ += level->second.device_seconds();
    level = built_.erase(level);
  }
}

std::size_t PyramidStore::device_bytes() const {
  std::size_t bytes = 0;
  for (const auto& [key, level] : built_) bytes += level.device_bytes();
  return bytes;
}

double PyramidStore::device_seconds() const {
  double seconds = dropped_device_seconds_;
  for (const auto& [key, level] : built_) seconds += level.device_seconds();
  return seconds;
}

}  // namespace mica::host
