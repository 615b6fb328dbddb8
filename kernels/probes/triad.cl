// a = b + factor * c: the memory bandwidth that the device can sustain in this form of a wave.

#include "wave/wave.h"

// Global size as for any wave kernel; a wave for each sixteen values.
WAVE_KERNEL void triad(global float* restrict a, global const float* restrict b,
                       global const float* restrict c, float factor) {
  const int first = WAVE_LANES * WAVE_ITEM_INDEX;
  wave_store_float(fma(wave_load_float(c + first), (wave_float)factor, wave_load_float(b + first)),
                   a + first);
}
