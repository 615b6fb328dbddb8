// The random numbers of a range of keys, for their test.

#include "wave/random_numbers.h"

// Number `dimension` of keys first_low + n with the upper half `key_high`, twice: alone, and as a lane of a
// wave. Global size as for any wave kernel, sixteen keys a wave.
WAVE_KERNEL void random_numbers(uint first_low, uint key_high, uint dimension, global float* restrict alone,
                                global float* restrict in_a_wave) {
  const int first = WAVE_LANES * WAVE_ITEM_INDEX;
  const wave_uint keys = first_low + (uint)first + wave_to_uint(WAVE_LANE);
  const wave_uint high = key_high, dimensions = dimension;
  wave_store_float(wave_random_uniform(keys, high, dimensions), in_a_wave + first);
#if MICA_WAVE_ITEMS
  const int from = WAVE_LANE, to = from + 1;
#else
  const int from = 0, to = WAVE_LANES;
#endif
  for (int lane = from; lane < to; ++lane)
    alone[first + lane] = random_uniform(first_low + (uint)(first + lane), key_high, dimension);
}
