// What `mica selftest` measures in units of the last place: the device's own functions, and those of the
// other kernels.

#include "wave/gaussian.h"
#include "wave/wave.h"

#define FUNCTION(name, value)                                                             \
  WAVE_KERNEL void name(global const float* restrict xs, global const float* restrict ys, \
                        global float* restrict z) {                                       \
    const int first = WAVE_LANES * WAVE_ITEM_INDEX;                                       \
    const wave_float x = wave_load_float(xs + first), y = wave_load_float(ys + first);    \
    wave_store_float(value, z + first);                                                   \
  }

// Each is a kernel of sixteen values a wave; y counts only where the function has two arguments.
FUNCTION(arithmetic_divide, x / y)
FUNCTION(arithmetic_sqrt, sqrt(x) + 0.0f * y)
FUNCTION(arithmetic_rsqrt, rsqrt(x) + 0.0f * y)
FUNCTION(arithmetic_exp, exp(x) + 0.0f * y)
FUNCTION(arithmetic_exp2, exp2(x) + 0.0f * y)
FUNCTION(arithmetic_log, log(x) + 0.0f * y)
FUNCTION(arithmetic_erf, erf(x) + 0.0f * y)
FUNCTION(arithmetic_atan2, atan2(y, x))
FUNCTION(arithmetic_wave_rsqrt, wave_rsqrt(x) + 0.0f * y)
FUNCTION(arithmetic_wave_reciprocal, wave_reciprocal(x) + 0.0f * y)
FUNCTION(arithmetic_gaussian_exp2, gaussian_exp2(x) + 0.0f * y)
FUNCTION(arithmetic_gaussian_cdf, gaussian_cdf_centred(x) + 0.0f * y)
