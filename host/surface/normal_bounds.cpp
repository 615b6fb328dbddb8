#include "host/surface/normal_bounds.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace mica::host {
namespace {

constexpr long kTile = 8;         // texels a side
constexpr long kMostTiles = 4;    // along an axis that are looked at; above it the next level is
constexpr double kFar = 1 << 30;  // texels from the origin, beyond which no footprint is looked at

long tiles(long texels, long side) {
  return (texels + side - 1) / side;
}

/// Calls visit(tile) for all tiles with texels [first, last] of a period, which may begin anywhere.
template <typename Visit>
void each_tile(long first, long last, long period, long side, const Visit& visit) {
  if (last - first + 1 >= period) first = 0, last = period - 1;
  const long shift = first - ((first % period) + period) % period;
  first -= shift, last -= shift;
  for (long tile = first / side; tile <= std::min(last, period - 1) / side; ++tile) visit(tile);
  for (long tile = 0; tile * side <= last - period; ++tile) visit(tile);
}

}  // namespace

NormalBounds::NormalBounds(const Surface& surface)
    : width_(surface.width()),
      height_(surface.height()),
      apron_(surface.interpolation() == Interpolation::bicubic ? 1 : 0),
      // The absolute Catmull-Rom weights sum to at most 25/16: of half the range beyond the middle.
      widen_(surface.interpolation() == Interpolation::bicubic ? 9.0 / 32 : 0) {
  Level tiles_of_texels{kTile, tiles(width_, kTile), tiles(height_, kTile), {}};
  const Level& level = tiles_of_texels;
  tiles_of_texels.boxes.resize(static_cast<std::size_t>(level.columns * level.rows));
  tbb::parallel_for(0L, level.rows, [&](long row) {
    for (long j = row * kTile; j < std::min((row + 1) * kTile, height_); ++j)
      for (long i = 0; i < width_; ++i)
        tiles_of_texels.boxes[static_cast<std::size_t>(row * level.columns + i / kTile)].extend(
            surface.texel(i, j));
  });
  levels_.push_back(std::move(tiles_of_texels));
  while (levels_.back().columns > 1 || levels_.back().rows > 1) {
    const Level& below = levels_.back();
    Level above{2 * below.side, tiles(below.columns, 2), tiles(below.rows, 2), {}};
    above.boxes.resize(static_cast<std::size_t>(above.columns * above.rows));
    for (long j = 0; j < below.rows; ++j)
      for (long i = 0; i < below.columns; ++i)
        above.boxes[static_cast<std::size_t>(j / 2 * above.columns + i / 2)].extend(
            below.boxes[static_cast<std::size_t>(j * below.columns + i)]);
    levels_.push_back(std::move(above));
  }
}

NormalBounds::Box NormalBounds::within(const Eigen::Vector2d& middle_uv,
                                       const Eigen::Vector2d& half_size_uv) const {
  const Eigen::Array2d size(static_cast<double>(width_), static_cast<double>(height_));
  const Eigen::Array2d low = (middle_uv - half_size_uv).array() * size - 0.5,
                       high = (middle_uv + half_size_uv).array() * size - 0.5;
  const bool is_near = low.abs().maxCoeff() < kFar && high.abs().maxCoeff() < kFar;  // false of no number
  if (!is_near) return levels_.back().boxes.front();
  const auto floor = [](double x) { return static_cast<long>(std::floor(x)); };
  const long left = floor(low.x()) - apron_, right = floor(high.x()) + 1 + apron_;
  const long bottom = floor(low.y()) - apron_, top = floor(high.y()) + 1 + apron_;
  const long longest = std::max(std::min(right - left + 1, width_), std::min(top - bottom + 1, height_));
  std::size_t n = 0;
  while (n + 1 < levels_.size() && levels_[n].side * kMostTiles < longest) ++n;
  const Level& level = levels_[n];
  Box box;
  each_tile(bottom, top, height_, level.side, [&](long row) {
    each_tile(left, right, width_, level.side, [&](long column) {
      box.extend(level.boxes[static_cast<std::size_t>(row * level.columns + column)]);
    });
  });
  const Eigen::Vector2d more = widen_ * box.sizes();
  return {box.min() - more, box.max() + more};
}

}  // namespace mica::host
