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

/// Point `index` of Sobol's sequence in four dimensions, in [0, 1)^4; the first two are those of
/// `low_discrepancy_point`. S. Joe and F. Y. Kuo, "Constructing Sobol Sequences with Better Two-Dimensional
/// Projections" (2008), dimensions 1 to 4.
/// @param first, second scrambles of the two halves, as above.
inline Eigen::Vector4d low_discrepancy_point4(std::uint32_t index, std::uint64_t first,
                                              std::uint64_t second) {
  std::uint32_t z = static_cast<std::uint32_t>(second), w = static_cast<std::uint32_t>(second >> 32);
  std::uint32_t columns_z[] = {1u << 31, 3u << 30}, columns_w[] = {1u << 31, 3u << 30, 1u << 29};
  for (std::uint32_t rest = index; rest; rest >>= 1) {
    if (rest & 1) z ^= columns_z[0], w ^= columns_w[0];
    const std::uint32_t next_z = columns_z[0] ^ (columns_z[0] >> 2) ^ columns_z[1];
    const std::uint32_t next_w = columns_w[0] ^ (columns_w[0] >> 3) ^ columns_w[1];
    columns_z[0] = columns_z[1], columns_z[1] = next_z;
    columns_w[0] = columns_w[1], columns_w[1] = columns_w[2], columns_w[2] = next_w;
  }
  const Eigen::Vector2d xy = low_discrepancy_point(index, first);
  return {xy.x(), xy.y(), z * 0x1p-32, w * 0x1p-32};
}

}  // namespace mica::host
