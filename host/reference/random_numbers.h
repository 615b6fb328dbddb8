#pragma once

#include <cstdint>

namespace mica::host::reference {

/// Word `dimension` of the stream `key`: Philox-2x32-10 with `key` as its counter (its lower half first) and
/// dimension / 2 as its key. [Salmon et al., SC 2011]
std::uint32_t random_bits(std::uint64_t key, std::uint32_t dimension);

/// Uniform in [0, 1), a multiple of 2^-24; what kernels/wave/random_numbers.h gives for the same two.
double random_uniform(std::uint64_t key, std::uint32_t dimension);

}  // namespace mica::host::reference
