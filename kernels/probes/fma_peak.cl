// The multiply-add rate that the device can sustain in this form of a wave: what benchmarks are measured
// against.

#include "wave/wave.h"

#define CHAINS 12  // independent, to cover the latency of a multiply-add

// Each lane runs CHAINS * 2 * rounds floating-point operations. Global size as for any wave kernel.
WAVE_KERNEL void fma_peak(int rounds, float factor, global float* restrict result) {
  WAVE_DECLARE_SCRATCH(scratch);
  wave_float x[CHAINS];
  for (int k = 0; k < CHAINS; ++k) x[k] = wave_to_float(WAVE_LANE + k);
  for (int round = 0; round < rounds; ++round) {
#pragma unroll
    for (int k = 0; k < CHAINS; ++k) x[k] = fma(x[k], factor, 1.0f);
  }
  wave_float sum = 0.0f;
  for (int k = 0; k < CHAINS; ++k) sum += x[k];
  result[WAVE_ITEM_INDEX] = wave_sum(sum, scratch);
}
