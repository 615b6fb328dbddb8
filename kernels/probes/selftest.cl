// What `mica selftest` asks of a device: the layout of the structs that it shares with the host, and its
// arithmetic in the special functions of the other kernels.

#include "images/image_types.h"
#include "pyramid/pyramid_types.h"
#include "struct_layout.h"
#include "types.h"
#include "wave/gaussian.h"
#include "wave/wave.h"

// Sizes and offsets in bytes, in the order of MICA_STRUCT_LAYOUT. Global size: 1.
kernel void selftest_layout(global int* restrict layout) {
#define SIZE(type) *layout++ = (int)sizeof(type);
#define OFFSET(type, field)                                                 \
  {                                                                         \
   private                                                                  \
    type value;                                                             \
    *layout++ = (int)((private char*)&value.field - (private char*)&value); \
  }
  MICA_STRUCT_LAYOUT(SIZE, OFFSET)
#undef SIZE
#undef OFFSET
}

#if MICA_WAVE_ITEMS
#define LOAD(pointer) (*((pointer) + WAVE_LANE))
#define STORE(value, pointer) (*((pointer) + WAVE_LANE) = (value))
#else
#define LOAD(pointer) vload16(0, pointer)
#define STORE(value, pointer) vstore16(value, 0, pointer)
#endif

// y = f(x), a wave for each sixteen values. Global size as for any wave kernel.
WAVE_KERNEL void selftest_gaussian_exp2(global const float* restrict x, global float* restrict y) {
  STORE(gaussian_exp2(LOAD(x + WAVE_LANES * WAVE_ITEM_INDEX)), y + WAVE_LANES * WAVE_ITEM_INDEX);
}

WAVE_KERNEL void selftest_gaussian_cdf_centred(global const float* restrict x, global float* restrict y) {
  STORE(gaussian_cdf_centred(LOAD(x + WAVE_LANES * WAVE_ITEM_INDEX)), y + WAVE_LANES * WAVE_ITEM_INDEX);
}
