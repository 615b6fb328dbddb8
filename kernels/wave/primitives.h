// What a wave of vectors asks of a processor beyond OpenCL: a mask's bits, packing, and rough roots and
// reciprocals. Included by wave.h.
#ifndef MICA_WAVE_PRIMITIVES_H
#define MICA_WAVE_PRIMITIVES_H

// x86 has the two primitives that OpenCL lacks: a mask's bits, and packing the chosen lanes to the front.
#ifndef MICA_AVX512
#if defined(__AVX512F__) && defined(__AVX512DQ__)
#define MICA_AVX512 1
#else
#define MICA_AVX512 0
#endif
#endif
#ifndef MICA_AVX2
#if defined(__AVX2__) && defined(__BMI2__)
#define MICA_AVX2 1
#else
#define MICA_AVX2 0
#endif
#endif

// Intel's runtime compiles for no processor, and chooses its instructions later: shuffles, rough roots and
// rough reciprocals are one each.
#ifndef MICA_NATIVE
#ifdef __INTEL_LLVM_COMPILER
#define MICA_NATIVE 1
#else
#define MICA_NATIVE 0
#endif
#endif

static inline uint wave_ballot(wave_int mask, private int* scratch) {
  (void)scratch;
#if MICA_AVX512
  return (ushort)__builtin_ia32_cvtd2mask512(mask);
#elif MICA_AVX2
  return (uint)__builtin_ia32_movmskps256(as_float8(mask.lo)) |
         (uint)__builtin_ia32_movmskps256(as_float8(mask.hi)) << 8;
#else
  const int16 lane_bit = (int16)(1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096, 8192, 16384, 32768);
  const int16 bits = mask & lane_bit;
  const int8 b8 = bits.lo | bits.hi;
  const int4 b4 = b8.lo | b8.hi;
  const int2 b2 = b4.lo | b4.hi;
  return (uint)(b2.lo | b2.hi);
#endif
}

// 1 / sqrt(x) of a normal number, relative error 2e-7.
static inline wave_float wave_rsqrt(wave_float x) {
#if MICA_AVX512
  const wave_float y = __builtin_ia32_rsqrt14ps512_mask(x, x, (ushort)0xffff);
  return y * fma(-0.5f * x * y, y, 1.5f);  // one step of Newton's
#elif MICA_AVX2
  const float8 low = __builtin_ia32_rsqrtps256(x.lo), high = __builtin_ia32_rsqrtps256(x.hi);
  const wave_float y = (wave_float)(low, high);
  return y * fma(-0.5f * x * y, y, 1.5f);
#elif MICA_NATIVE
  const wave_float y = native_rsqrt(x);
  return y * fma(-0.5f * x * y, y, 1.5f);
#else
  return rsqrt(x);
#endif
}

// 1 / sqrt(x) of a normal number, relative error 6e-5.
static inline wave_float wave_rough_rsqrt(wave_float x) {
#if MICA_AVX512
  return __builtin_ia32_rsqrt14ps512_mask(x, x, (ushort)0xffff);
#else
  return wave_rsqrt(x);
#endif
}

// 1 / x of a normal number, relative error 2e-7.
static inline wave_float wave_reciprocal(wave_float x) {
#if MICA_AVX512
  const wave_float y = __builtin_ia32_rcp14ps512_mask(x, x, (ushort)0xffff);
  return y * fma(-x, y, 2.0f);  // one step of Newton's
#elif MICA_AVX2
  const float8 low = __builtin_ia32_rcpps256(x.lo), high = __builtin_ia32_rcpps256(x.hi);
  const wave_float y = (wave_float)(low, high);
  return y * fma(-x, y, 2.0f);
#elif MICA_NATIVE
  const wave_float y = native_recip(x);
  return y * fma(-x, y, 2.0f);
#else
  return 1.0f / x;
#endif
}

#if !MICA_AVX512 && (MICA_AVX2 || MICA_NATIVE)
typedef float8 wave_half_float_anywhere __attribute__((aligned(4)));

// The lanes in four bits, a byte each, in their order.
constant uint wave_packed_quarters[16] = {0x0, 0x0,   0x1,   0x100,   0x2,   0x200,   0x201,   0x20100,
                                          0x3, 0x300, 0x301, 0x30100, 0x302, 0x30200, 0x30201, 0x3020100};

// The lanes in eight bits, a byte each: in their order, then any.
static inline ulong wave_packed_lanes(uint bits) {
#if MICA_AVX2
  const ulong chosen = 0xfful * __builtin_ia32_pdep_di(bits, 0x0101010101010101ul);
  return __builtin_ia32_pext_di(0x0706050403020100ul, chosen);
#else
  const ulong low = wave_packed_quarters[bits & 15u], high = wave_packed_quarters[bits >> 4] + 0x4040404u;
  return low | high << 8 * popcount(bits & 15u);
#endif
}

// The lanes in `bits` first, in their order.
static inline float8 wave_packed_half(float8 value, uint bits) {
  const int8 lanes = convert_int8(as_uchar8(wave_packed_lanes(bits)));
#if MICA_AVX2
  return __builtin_ia32_permvarsf256(value, lanes);
#else
  return shuffle(value, as_uint8(lanes));
#endif
}
#endif

// Writes the lanes in `bits`, packed, to list[0...]; what follows them, up to sixteen in all, is undefined
// afterwards.
static inline void wave_pack(private float* list, uint bits, wave_float value) {
#if MICA_AVX512
  *(private wave_float_anywhere*)list = __builtin_ia32_compresssf512_mask(value, value, (ushort)bits);
#elif MICA_AVX2 || MICA_NATIVE
  *(private wave_half_float_anywhere*)list = wave_packed_half(value.lo, bits & 0xffu);
  list += popcount(bits & 0xffu);
  *(private wave_half_float_anywhere*)list = wave_packed_half(value.hi, bits >> 8);
#else
  float lanes[WAVE_LANES];
  vstore16(value, 0, lanes);
  for (; bits; bits &= bits - 1) *list++ = lanes[lowest_bit(bits)];
#endif
}

#endif  // MICA_WAVE_PRIMITIVES_H
