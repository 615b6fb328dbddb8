// A wave: sixteen lanes that work on one query, from one source for both kinds of device.
//
// MICA_WAVE_ITEMS 0: the lanes are the elements of a float16 in one work-item (CPUs: one vector register).
// MICA_WAVE_ITEMS 1: the lanes are the sixteen work-items of a work-group (GPUs); control flow is uniform in
// the group,
//                    and what lanes tell each other goes through local memory.
// Masks are integers, -1 or 0 a lane, in both.
#ifndef MICA_WAVE_H
#define MICA_WAVE_H

#ifndef MICA_WAVE_ITEMS
#define MICA_WAVE_ITEMS 0
#endif

#define WAVE_LANES 16

// Index of the lowest set bit; `bits` is not zero.
static inline int lowest_bit(uint bits) {
  return 31 - (int)clz(bits & (0u - bits));
}

#if MICA_WAVE_ITEMS

// PoCL 3.1 gives all groups the same local memory in functions that are not inlined, and its threads write
// over each other's: docs/devices.md. Elsewhere that is left to the compiler: Intel's cannot take all in one.
#ifdef POCL_DEVICE_ADDRESS_BITS
#define inline inline __attribute__((always_inline))
#endif

typedef float wave_float;
typedef int wave_int;
typedef uint wave_uint;
#define WAVE_KERNEL kernel
#define WAVE_SHARED local
#define WAVE_DECLARE_SCRATCH(name) local int name[WAVE_LANES]
#define WAVE_ITEM_INDEX ((int)get_group_id(0))
#define WAVE_LANE ((int)get_local_id(0))
#define wave_to_float(x) convert_float(x)
#define wave_to_int(x) convert_int(x)
#define wave_bits_of(x) as_int(x)
#define wave_from_bits(x) as_float(x)
#define wave_to_uint(x) as_uint(x)
#define wave_uint_to_float(x) convert_float(x)
#define wave_mask(condition) (-(condition))

static inline wave_float wave_select(wave_float otherwise, wave_float chosen, wave_int mask) {
  return mask ? chosen : otherwise;
}

// The bits of the lanes whose mask is set.
static inline uint wave_ballot(wave_int mask, local int* scratch) {
  scratch[WAVE_LANE] = mask ? (1 << WAVE_LANE) : 0;
  barrier(CLK_LOCAL_MEM_FENCE);
  int bits = 0;
  for (int lane = 0; lane < WAVE_LANES; ++lane) bits |= scratch[lane];
  barrier(CLK_LOCAL_MEM_FENCE);
  return (uint)bits;
}

static inline float wave_sum(wave_float x, local int* scratch) {
  scratch[WAVE_LANE] = as_int(x);
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int half_lanes = WAVE_LANES / 2; half_lanes > 0; half_lanes /= 2) {
    if (WAVE_LANE < half_lanes)
      scratch[WAVE_LANE] = as_int(as_float(scratch[WAVE_LANE]) + as_float(scratch[WAVE_LANE + half_lanes]));
    barrier(CLK_LOCAL_MEM_FENCE);
  }
  const float sum = as_float(scratch[0]);
  barrier(CLK_LOCAL_MEM_FENCE);
  return sum;
}

#define wave_rsqrt(x) rsqrt(x)
#define wave_rough_rsqrt(x) rsqrt(x)
#define wave_reciprocal(x) (1.0f / (x))

static inline float wave_max(wave_float x, local int* scratch) {
  scratch[WAVE_LANE] = as_int(x);
  barrier(CLK_LOCAL_MEM_FENCE);
  float largest = as_float(scratch[0]);
  for (int lane = 1; lane < WAVE_LANES; ++lane) largest = max(largest, as_float(scratch[lane]));
  barrier(CLK_LOCAL_MEM_FENCE);
  return largest;
}

#define wave_load_short(pointer) convert_int((pointer)[WAVE_LANE])
#define wave_load_char(pointer) convert_int((pointer)[WAVE_LANE])
#define wave_load_float(pointer) ((pointer)[WAVE_LANE])
#define wave_load_int(pointer) ((pointer)[WAVE_LANE])
#define wave_store_float(value, pointer) ((pointer)[WAVE_LANE] = (value))
// Lane (x, y) = (lane & 3, lane >> 2) reads pointer[y * row + x].
#define wave_load_4x4(pointer, row) ((pointer)[(WAVE_LANE >> 2) * (row) + (WAVE_LANE & 3)])
#define wave_load_short_4x4(pointer, row) convert_int((pointer)[(WAVE_LANE >> 2) * (row) + (WAVE_LANE & 3)])

// Writes the lanes in `bits`, packed, to list[0...].
static inline void wave_pack(local float* list, uint bits, wave_float value) {
  const uint below = bits & ((1u << WAVE_LANE) - 1u);
  if ((bits >> WAVE_LANE) & 1u) list[popcount(below)] = value;
}
#define wave_list_load(list) ((list)[WAVE_LANE])
#define wave_list_store(list, value) ((list)[WAVE_LANE] = (value))
#define wave_list_sync() barrier(CLK_LOCAL_MEM_FENCE)

#else  // one work-item, vectors

typedef float16 wave_float;
typedef int16 wave_int;
typedef uint16 wave_uint;
// Vectors at any address: some compilers split vload16 and vstore16 into quarters.
typedef float16 wave_float_anywhere __attribute__((aligned(4)));
typedef int4 wave_quarter_int_anywhere __attribute__((aligned(4)));
typedef int16 wave_int_anywhere __attribute__((aligned(4)));
typedef short16 wave_short_anywhere __attribute__((aligned(2)));
typedef char16 wave_char_anywhere __attribute__((aligned(1)));
// Compilers that spread neighbouring work-items over a vector are told that each has vectors of its own:
// Intel's runtime would take them apart, and be slower by far.
#define WAVE_KERNEL kernel __attribute__((vec_type_hint(float16)))
#define WAVE_SHARED private
#define WAVE_DECLARE_SCRATCH(name) int name[1]
#define WAVE_ITEM_INDEX ((int)get_global_id(0))
#define WAVE_LANE ((int16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15))
#define wave_to_float(x) convert_float16(x)
#define wave_to_int(x) convert_int16(x)
#define wave_bits_of(x) as_int16(x)
#define wave_from_bits(x) as_float16(x)
#define wave_to_uint(x) as_uint16(x)
#define wave_uint_to_float(x) \
  convert_float16(as_int16(x))  // right for values below 2^31, whose conversion is cheaper
#define wave_mask(condition) (condition)

static inline wave_float wave_select(wave_float otherwise, wave_float chosen, wave_int mask) {
  return select(otherwise, chosen, mask);
}

#include "wave/primitives.h"

static inline float wave_sum(wave_float x, private int* scratch) {
  (void)scratch;
  const float8 s8 = x.lo + x.hi;
  const float4 s4 = s8.lo + s8.hi;
  const float2 s2 = s4.lo + s4.hi;
  return s2.lo + s2.hi;
}

static inline float wave_max(wave_float x, private int* scratch) {
  (void)scratch;
  const float8 m8 = max(x.lo, x.hi);
  const float4 m4 = max(m8.lo, m8.hi);
  const float2 m2 = max(m4.lo, m4.hi);
  return max(m2.lo, m2.hi);
}

#define wave_load_short(pointer) convert_int16(*(global const wave_short_anywhere*)(pointer))
#define wave_load_char(pointer) convert_int16(*(global const wave_char_anywhere*)(pointer))
#define wave_load_float(pointer) (*(global const wave_float_anywhere*)(pointer))
#define wave_load_int(pointer) (*(global const wave_int_anywhere*)(pointer))
#define wave_store_float(value, pointer) (*(global wave_float_anywhere*)(pointer) = (value))

// Lane (x, y) = (lane & 3, lane >> 2) reads pointer[y * row + x].
static inline wave_int wave_load_4x4(global const int* pointer, int row) {
#define ROW(y) (*(global const wave_quarter_int_anywhere*)(pointer + (y)*row))
  wave_int rows = (int16)(ROW(0), ROW(1), ROW(2), ROW(3));
#undef ROW
#if MICA_AVX512
  // As it stands: the compiler would merge these loads with those of neighbours, and shuffle twice as often.
  __asm__("" : "+v"(rows));
#endif
  return rows;
}

static inline wave_int wave_load_short_4x4(global const short* pointer, int row) {
  return convert_int16((short16)(vload4(0, pointer), vload4(0, pointer + row), vload4(0, pointer + 2 * row),
                                 vload4(0, pointer + 3 * row)));
}

#define wave_list_load(list) (*(private const wave_float_anywhere*)(list))
#define wave_list_store(list, value) (*(private wave_float_anywhere*)(list) = (value))
#define wave_list_sync()

#endif

// wave_load_4x4 and its neighbours to the right and above.
static inline void wave_load_quads(global const int* pointer, int row, private wave_int* v00,
                                   private wave_int* v10, private wave_int* v01, private wave_int* v11) {
  *v00 = wave_load_4x4(pointer, row), *v10 = wave_load_4x4(pointer + 1, row);
#if MICA_WAVE_ITEMS
  *v01 = wave_load_4x4(pointer + row, row), *v11 = wave_load_4x4(pointer + row + 1, row);
#else
#define ROW(x) (*(global const wave_quarter_int_anywhere*)(pointer + 4 * row + (x)))
  const int4 row_0 = ROW(0), row_1 = ROW(1);
#undef ROW
  const uint16 next_row = (uint16)(4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19);
  *v01 = shuffle2(*v00, (int16)(row_0, row_0, row_0, row_0), next_row);
  *v11 = shuffle2(*v10, (int16)(row_1, row_1, row_1, row_1), next_row);
#endif
}

#endif  // MICA_WAVE_H
