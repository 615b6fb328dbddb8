#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/methods/beckmanns/lobes.h"
#include "kernels/types.h"

namespace mica::host {

/// Variance of the Gaussian that a cell of the pyramid stands for, in its spacings^2, but for the finest
/// level, that of the lobes: wider than their position kernel, so that 5e-5 is left of waves as short as a
/// spacing.
constexpr double kCellVariance = 0.5;

/// One level of a pyramid of slopes.
struct SlopeLevel {
  int width = 0, height = 0;             ///< cells a period
  std::size_t offset = 0;                ///< of its first number
  float mean_unit = 0, spread_unit = 0;  ///< of its numbers
};

/// Means and covariances of slopes at every scale, for footprints of any size. [Che18] sec. 4.2.2, with
/// Gaussians in place of boxes: weighted sums of cells then have the moments of a Gaussian footprint, but for
/// a ripple that the choice of the level keeps small.
///
/// A level is five planes of (width + 3) x (height + 3) 16-bit numbers, the last three of either side a copy
/// of the first: mean x and y, and the Cholesky factor xx, yx, yy of the slopes' covariance.
struct SlopePyramid {
  std::vector<SlopeLevel> levels;  ///< from fine to coarse; the last one is a single cell
  std::vector<std::int16_t> numbers;

  std::size_t bytes() const { return numbers.size() * sizeof(numbers[0]); }
};

/// Builds in parallel.
/// @param with_finest false: begins with half the resolution of the lobes, which hold the finest level.
SlopePyramid build_slope_pyramid(const LobeStructure& lobes, bool with_finest);

/// Bytes that it would take for a grid of this many lobes.
std::size_t slope_pyramid_bytes(int width, int height, bool with_finest);

}  // namespace mica::host
