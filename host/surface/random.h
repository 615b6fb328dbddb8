#pragma once

#include <cstdint>

/// Counter-based random numbers: a pure function of what they are for, so that results depend neither on the
/// order in which they are drawn nor on the number of threads nor on the standard library.
namespace mica::host::synthesis {

/// The output function of SplitMix64 [Steele, Lea, Flood 2014].
inline std::uint64_t mix(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/// 64 random bits for item `index` of an independent `stream`.
inline std::uint64_t random_bits(std::uint64_t seed, std::uint64_t stream, std::uint64_t index) {
  return mix(mix(mix(seed) + stream) + index);
}

/// Uniform in [0, 1), a multiple of 2^-53.
inline double random_unit(std::uint64_t seed, std::uint64_t stream, std::uint64_t index) {
  return static_cast<double>(random_bits(seed, stream, index) >> 11) * 0x1p-53;
}

}  // namespace mica::host::synthesis
