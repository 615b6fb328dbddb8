#pragma once

#include "host/surface/local_filter.h"

namespace mica::host {

/// Where a square's rounded texels say more than that they are smooth.
struct Facets {
  std::vector<int> of_texel;     ///< numbers from 0
  std::vector<bool> is_cut_out;  ///< mostly more than a step apart from what is around: flat, at any height
  std::vector<bool> is_plane;    ///< wide, half a step from 0 at most: rounded, 0 is no number
};

/// Facets are neighbours that are equal, up to what scaling to length 1 moves them by.
/// @param rounded in steps.
Facets find_facets(int side, const PairGrid& rounded);

}  // namespace mica::host
