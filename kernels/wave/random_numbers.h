// Random numbers that are a function of (key, dimension) alone: the same for every batch, thread and device.
//
// A key of 64 bits names a stream, and `dimension` counts its numbers. They are the words of Philox-2x32-10
// [Salmon et al., "Parallel random numbers: as easy as 1, 2, 3", SC 2011] with the key as its counter and
// dimension / 2 as its key: keys may be consecutive. A uniform is the upper 24 bits of a word, so that it is
// below 1 and exact as a float. host/reference/random_numbers.h says it again for the host;
// tests/methods/random_numbers_test.cpp looks at both.
#ifndef MICA_RANDOM_NUMBERS_H
#define MICA_RANDOM_NUMBERS_H

#include "wave/wave.h"

#define RANDOM_ROUNDS 10

// Word `dimension` of a stream, and the uniform in [0, 1) that it makes; for one number and for a wave of
// them.
#define DEFINE_RANDOM(prefix, uint_type, float_type, to_float)                                            \
  static inline uint_type prefix##_bits(uint_type key_low, uint_type key_high, uint_type dimension) {     \
    uint_type left = key_low, right = key_high, round_key = dimension >> 1;                               \
    for (int round = 0; round < RANDOM_ROUNDS; ++round) {                                                 \
      const uint_type multiplier = 0xd256d193u;                                                           \
      const uint_type high = mul_hi(multiplier, left), low = multiplier * left;                           \
      left = high ^ round_key ^ right;                                                                    \
      right = low;                                                                                        \
      round_key += 0x9e3779b9u;                                                                           \
    }                                                                                                     \
    const uint_type odd = 0u - (dimension & 1u); /* all ones where the second word is asked for */        \
    return (left & ~odd) | (right & odd);                                                                 \
  }                                                                                                       \
  static inline float_type prefix##_uniform(uint_type key_low, uint_type key_high, uint_type dimension) { \
    return to_float(prefix##_bits(key_low, key_high, dimension) >> 8) * (1.0f / 16777216);                \
  }

DEFINE_RANDOM(random, uint, float, convert_float)  // random_bits, random_uniform
DEFINE_RANDOM(wave_random, wave_uint, wave_float,
              wave_uint_to_float)  // wave_random_bits, wave_random_uniform
#undef DEFINE_RANDOM

#endif  // MICA_RANDOM_NUMBERS_H
