#pragma once

#include <vector>

namespace mica::host {

/// Numbers that were rounded to whole ones, or nearly; row by row.
struct RoundedGrid {
  int width = 0, height = 0;
  std::vector<float> values;
};

/// The smoothest numbers that round to those of two grids of one size: the least sum of squared second
/// differences within the grid, along u, v and the diagonals, under the bounds of half a step either way, by
/// an accelerated projected gradient [Beck and Teboulle 2009]. From long strides to short ones, so that wide
/// plateaus need no more iterations than narrow ones. Parallel; the same for any number of threads.
/// @param iterations with neighbours.
void restore_steps(int iterations, RoundedGrid* u, RoundedGrid* v);

}  // namespace mica::host
