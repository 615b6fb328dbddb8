#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace mica::host {

/// Point `index` of Sobol's (0, 2)-sequence, in [0, 1)^2: each 2^k points from a multiple of 2^k on fall one
/// into each box of area 2^-k.
/// @param scramble its halves flip the digits of the two coordinates: drawn at random, every single point is
/// uniform. Kollig and Keller, "Efficient Multidimensional Sampling" (2002), sec. 2.2.
inline Eigen::Vector2d low_discrepancy_point(std::uint32_t index, std::uint64_t scramble) {
  std::uint32_t x = static_cast<std::uint32_t>(scramble), y = static_cast<std::uint32_t>(scramble >> 32);
  std::uint32_t column_x = 1u << 31, column_y = 1u << 31;  // columns of the generator matrices
  for (; index; index >>= 1) {
    if (index & 1) x ^= column_x, y ^= column_y;
    column_x >>= 1;
    column_y ^= column_y >> 1;
  }
  return {x * 0x1p-32, y * 0x1p-32};
}

}  // namespace mica::host
