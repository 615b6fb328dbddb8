#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "host/scene/pixel_filter.h"

namespace mica::host {

/// Samples at the centres of subpixels, which neighbouring pixels share: each pixel is a weighted sum of
/// those within reach of its filter. Only pixels that need them have samples.
struct Lattice {
  /// Some samples, by cell: which of it; of an empty cell none.
  using Choice = std::vector<std::vector<bool>>;

  static constexpr std::uint32_t kNone = ~std::uint32_t{0};
  int width = 0, margin = 0;  ///< pixels: of the image, and around the block's rows on all sides
  int subpixels = 1;
  FilterSum filter;
  std::vector<std::uint32_t> first_sample;  ///< by row and column with margins; of kNone there is none

  std::size_t cell(int row, int column) const {
    return static_cast<std::size_t>(row + margin) * static_cast<std::size_t>(width + 2 * margin) +
           static_cast<std::size_t>(column + margin);
  }

  std::size_t cells(int rows) const { return cell(rows + margin, -margin); }

  /// Pixels at some distances from a pixel, along the axis along which they are further away.
  struct Rings {
    int nearest, farthest;
  };
  Rings all() const { return {0, margin}; }

  /// Calls add(sample, weight) for all that a pixel of the block sees in some rings about it, in an order
  /// that is always the same.
  template <typename Add>
  void sum(int row, int column, const Rings& rings, const Add& add) const {
    const auto n = static_cast<std::size_t>(subpixels);
    for (int down = -margin; down <= margin; ++down)
      for (int right = -margin; right <= margin; ++right) {
        const int ring = std::max(std::abs(down), std::abs(right));
        if (ring < rings.nearest || ring > rings.farthest) continue;
        const std::uint32_t first = first_sample[cell(row + down, column + right)];
        const double* down_weights = &filter.weights[static_cast<std::size_t>(down + margin) * n];
        const double* right_weights = &filter.weights[static_cast<std::size_t>(right + margin) * n];
        for (std::size_t j = 0; j < n; ++j)
          for (std::size_t i = 0; i < n; ++i)
            if (const double weight = down_weights[j] * right_weights[i]; weight > 0)
              add(first + j * n + i, weight);
      }
  }
};

}  // namespace mica::host
