#pragma once

#include <vector>

#include "host/methods/beckmanns/lobe_query.h"
#include "host/methods/beckmanns/slope_pyramid.h"
#include "kernels/types.h"

namespace mica::host {

/// Variance, in spacings^2, that the weights of a pyramid's cells need at least: their sums then ripple by
/// 2 exp(-2 pi^2 variance).
constexpr double kSmallRipple = 0.49;   ///< 1.3e-4; footprints from 2 texels up have it on the second level
constexpr double kMiddleRipple = 0.26;  ///< 1e-2

/// A footprint on the coarsest level that lets its cells have such weights. Where all are too coarse, the
/// finest when that is the lobes' own, and otherwise none.
device_types::mica_slope_footprint to_slope_footprint(const LobeWeights& weights,
                                                      const device_types::mica_map_grid& grid,
                                                      const std::vector<SlopeLevel>& levels,
                                                      double least_variance);

}  // namespace mica::host
