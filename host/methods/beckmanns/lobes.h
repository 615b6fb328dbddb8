#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/surface/surface.h"
#include "kernels/types.h"

namespace mica::host {

constexpr int kLargest16 = 32767;  ///< of what 16 bits with a sign hold

/// One anisotropic, non-centred Beckmann lobe in the slope domain, without roughness. [Che18] Eqs. 4-6.
struct Lobe {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();  ///< slope
  /// Cholesky factor (xx, yx, yy) of the slopes' covariance as seen on the disk: S with covariance B S B,
  /// B = d slope / d normal at the mean. A roughness adds its square to the diagonal of S.
  double spread_xx = 0, spread_yx = 0, spread_yy = 0;
};

/// The mixture of `beckmanns` as the kernels read it: lobes in 16-bit numbers relative to their leaf, and the
/// two levels of a min-max hierarchy over their slopes, on the implicit grid of elements.
struct LobeStructure {
  device_types::mica_map_grid grid{};     ///< of elements
  float slope_unit = 0, spread_unit = 0;  ///< of the numbers in nodes
  std::vector<std::int16_t> lobes;        ///< MICA_LOBE_LEAF shorts a leaf, leaf by leaf, tile by tile
  std::vector<std::int16_t> block_nodes;  ///< MICA_MIXTURE_NODE_STRIDE a block: bounds of its sixteen tiles
  std::vector<std::int16_t> tile_nodes;   ///< MICA_MIXTURE_NODE_STRIDE a tile: bounds of its sixteen leaves

  std::size_t bytes() const;
  /// A lobe as it is stored. @param i, j of the grid.
  Lobe lobe(int i, int j) const;
};

/// Bytes that `build_lobes` would take for a map of this size.
std::size_t lobe_structure_bytes(int width, int height, int elements);

/// Fits a lobe to the slopes under the position kernel of every element, by quadrature. Constant texels give
/// lobes without a spread: none straddles two of them.
/// @param elements a texel and axis, 1 to kMaxElements. Throws UsageError for another number and for a
/// bicubic surface.
LobeStructure build_lobes(const Surface& surface, int elements);

}  // namespace mica::host
