#pragma once

#include <cstdint>

/// Counter-based random numbers: a pure function of what they are for, so that results depend neither on the
/// order in which they are drawn nor on the number of threads nor on the standard library.
namespace mica::host {

constexpr std::uint64_t kGoldenBits = 0x9e3779b97f4a7c15u;  // 2^64 / the golden ratio, odd

/// The finaliser of SplitMix64 [Steele, Lea, Flood 2014]: a bijection whose bits all depend on all of `x`.
inline std::uint64_t scramble_bits(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/// The first output of SplitMix64 from the state `x`.
inline std::uint64_t mix_bits(std::uint64_t x) {
  return scramble_bits(x + kGoldenBits);
}

/// 64 random bits for item `index` of an independent `stream`.
inline std::uint64_t random_bits(std::uint64_t seed, std::uint64_t stream, std::uint64_t index) {
  return mix_bits(mix_bits(mix_bits(seed) + stream) + index);
}

/// Uniform in [0, 1), a multiple of 2^-53.
inline double random_unit(std::uint64_t seed, std::uint64_t stream, std::uint64_t index) {
  return static_cast<double>(random_bits(seed, stream, index) >> 11) * 0x1p-53;
}

}  // namespace mica::host
