#pragma once

#include <cstddef>

#include "host/methods/map/map_structure.h"
#include "host/surface/surface.h"

namespace mica::host {

/// Variance of a mixture's position kernel, in spacings^2: at half a spacing it has fallen to half its peak.
/// [Yan16], [Che18] sec. 3.1.
constexpr double kPositionKernelVariance = 0.18033688011112043;  // 1 / (8 ln 2)

/// Largest number of elements a texel and axis.
constexpr int kMaxElements = 4;

/// The structure of `gaussians`: normals as for triangles, of which the kernel makes its elements as it goes.
/// Nodes are those of mixture_bound.h.
/// @param elements a texel and axis, 1 to kMaxElements. Throws UsageError for another number and for a
/// bicubic surface.
MapStructure build_gaussian_mixture(const Surface& surface, int elements);

/// Bytes that `build_gaussian_mixture` would take for a map of this size, with any number of elements.
std::size_t gaussian_mixture_bytes(int width, int height);

}  // namespace mica::host
