#pragma once

#include <array>
#include <vector>

namespace mica::host {

/// Numbers that were rounded to whole ones, or nearly, on a periodic grid; row by row.
struct RoundedGrid {
  int width = 0, height = 0;
  std::vector<float> values;
};

/// 0 to 1 for every number of a grid, along u, v, and the diagonals up to the right and down to the right.
using SmoothShares = std::array<std::vector<float>, 4>;

/// How far second differences of two grids are those of rounding alone: what is smooth may be found again
/// from its neighbours, and elsewhere numbers carry more than a step.
/// @param stride between the texels of a second difference.
SmoothShares smooth_shares(const RoundedGrid& u, const RoundedGrid& v, int stride);

/// The smoothest numbers that round to those of two grids of one size: the least sum of squared second
/// differences, with their shares, under the bounds of half a step either way, by an accelerated projected
/// gradient [Beck and Teboulle 2009]. From long strides to short ones, so that wide plateaus need no more
/// iterations than narrow ones. Parallel; the same for any number of threads.
/// @param iterations with neighbours.
void restore_steps(int iterations, RoundedGrid* u, RoundedGrid* v);

}  // namespace mica::host
