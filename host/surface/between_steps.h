#pragma once

#include <cstdint>

#include "host/surface/local_filter.h"

namespace mica::host {

/// What may lie behind numbers that were rounded.
struct BetweenSteps {
  PairGrid mean;  ///< the best guess
  PairGrid draw;  ///< one of those that round to the same
};

/// Sees rounded numbers as a random field, normal with a power spectrum of its own in every window, of which
/// intervals a step wide are known. The spectrum is that of the rounded ones less that of rounding, which
/// rounding the smoothest ones again tells: it is white of variance 1/12 where texels change by more than a
/// step, and falls on few frequencies where they change by less [Widrow and Kollar 2008]. Draws are a Gibbs
/// sampler's [Geman and Geman 1984]; the mean is theirs where texels are smooth, and elsewhere Wiener's.
/// @param rounded in steps, of a periodic square. @param side a multiple of LocalFilter::kHop, at least
/// LocalFilter::kWindow. @param draws after a third as many that are not counted.
/// @param smoothing iterations of the smoothest numbers, see restore_steps.
BetweenSteps between_steps(int side, const PairGrid& rounded, int draws, int smoothing, std::uint64_t seed);

/// Numbers that are uniform in their intervals: all that is known where steps are small.
PairGrid anywhere_between_steps(const PairGrid& rounded, std::uint64_t seed);

}  // namespace mica::host
