// How precisely triangles are integrated: what each step of it may be off by.
#ifndef MICA_PRECISION_H
#define MICA_PRECISION_H

#include "wave/gaussian.h"
#include "wave/quadrature.h"

// 0: densities within 1e-4, 1: within 1e-3, 2: within 1e-2, relative L2; host/methods/triangles/.
#ifndef MICA_PRECISION
#define MICA_PRECISION 0
#endif

// 1: integrals return the floating-point operations that they take instead (a fused multiply-add is two); the
// benchmark's share of the device's peak is made of it.
#ifndef MICA_COUNT_FLOPS
#define MICA_COUNT_FLOPS 0
#endif
#if MICA_COUNT_FLOPS
#define COUNTED(flops, value) ((wave_float)((float)(flops)) + 0.0f * (value))
#else
#define COUNTED(flops, value) (value)
#endif

// Of one point of a right triangle, and of one of a strip, which is two exponentials and four integrals.
#if MICA_PRECISION == 0
#define POINT_FLOPS 48
#define STRIP_FLOPS 0
#elif MICA_PRECISION == 1
#define POINT_FLOPS 36
#define STRIP_FLOPS 136
#else
#define POINT_FLOPS 28
#define STRIP_FLOPS 108
#endif

#define MINUS_HALF_LOG2_E (-(EXP2_SCALE * EXP2_SCALE))

// Gauss-Legendre points for a Gaussian, times a Gaussian's integral up to a line of slope <= 1, on a range of
// `range` standard deviations: their number and the first one's row. Over 10^5 random right triangles the
// error is, of the Gaussian's integral, 3e-6 rms and 6e-5 at most by precision 0; of those as long as a rule
// takes, by the worst of the rules, 1.5e-4 and 1.4e-3 by precision 1, 2.4e-3 and 1.2e-2 by precision 2.
static inline int legendre_rule(float range, private int* count) {
#if MICA_PRECISION == 0
  if (range <= 2.3f) return *count = 4, 5;
  if (range <= 3.7f) return *count = 6, 14;
  if (range <= 5.3f) return *count = 8, 27;
  if (range <= 6.8f) return *count = 10, 35;
  if (range <= 8.2f) return *count = 12, 45;
  if (range <= 10.3f) return *count = 16, 57;
  return *count = 20, 73;
#elif MICA_PRECISION == 1
  if (range <= 1.8f) return *count = 3, 2;
  if (range <= 2.9f) return *count = 4, 5;
  if (range <= 4.0f) return *count = 5, 9;
  if (range <= 5.0f) return *count = 6, 14;
  if (range <= 6.0f) return *count = 7, 20;
  if (range <= 7.0f) return *count = 8, 27;
  if (range <= 8.6f) return *count = 10, 35;
  return *count = 12, 45;
#else
  if (range <= 1.6f) return *count = 2, 0;
  if (range <= 3.0f) return *count = 3, 2;
  if (range <= 4.2f) return *count = 4, 5;
  if (range <= 5.3f) return *count = 5, 9;
  if (range <= 6.6f) return *count = 6, 14;
  return *count = 7, 20;
#endif
}

// What right triangles within the cutoff are integrated beyond it: the lower the cutoff, the more of a
// density would be lost where triangles are large beside the lobe.
#if MICA_PRECISION == 0
#define BEYOND_CUTOFF 0.0f
#else
#define BEYOND_CUTOFF 3.0f
#endif

// Right triangles whose ranges are shorter are listed apart, in standard deviations.
#if MICA_PRECISION == 0
#define SHORT_RANGE 3.7f
#else
#define SHORT_RANGE 3.0f
#endif

// Whitened length of quads' shorter edges up to which strips take them, and Gauss-Legendre points for it.
// Across the diagonal the integrand has a kink, on which points converge slowly: up to 1e-3 of a quad is
// left, too much for precision 0.
#define THIN 3.0f
static inline int strip_rule(float length, private int* count) {
#if MICA_PRECISION < 2
  if (length <= 1.8f) return *count = 3, 2;
  return *count = 4, 5;
#else
  if (length <= 1.6f) return *count = 2, 0;
  return *count = 3, 2;
#endif
}

// Squared length of the longest whitened edge up to which 3, 6 and 12 points of a triangle do.
#if MICA_PRECISION == 0
#define THREE_POINTS 0.06f
#define SIX_POINTS 1.4f
#define TWELVE_POINTS 4.0f
#elif MICA_PRECISION == 1
#define THREE_POINTS 0.25f
#define SIX_POINTS 2.5f
#define TWELVE_POINTS 6.0f
#else
#define THREE_POINTS 1.0f
#define SIX_POINTS 5.0f
#define TWELVE_POINTS 5.0f
#endif

// exp2 and the normal distribution, as gaussian.h has them, where less will do.
#if MICA_PRECISION == 2
// Relative error 8e-5.
static inline wave_float triangle_exp2(wave_float x) {
  const wave_float shifted = x + 12582912.0f;
  const wave_float f = x - (shifted - 12582912.0f);
  const wave_float p = fma(f, fma(f, fma(f, 0.0551716704f, 0.242611143f), 0.693260987f), 0.999928072f);
  return wave_from_bits(wave_bits_of(p) + (wave_bits_of(shifted) << 23));
}
// Absolute error 8e-5; constant for |x| >= 3.9.
#define TRIANGLE_CDF_SCALE 0.36261886f  // sqrt(2) / 3.9
static inline wave_float triangle_cdf(wave_float z) {
  z = min(max(z, -1.41421356f), 1.41421356f);
  const wave_float y = fma(z, z, -1.0f);
  wave_float p = fma(y, 0.0171520848f, -0.0426773276f);
  p = fma(y, p, 0.0588438978f);
  p = fma(y, p, -0.0933122262f);
  p = fma(y, p, 0.153295792f);
  p = fma(y, p, -0.236846316f);
  p = fma(y, p, 0.497121285f);
  return z * p;
}
#elif MICA_PRECISION == 1
#define triangle_exp2 gaussian_exp2
// Absolute error 9e-6; constant for |x| >= 4.8.
#define TRIANGLE_CDF_SCALE 0.29462783f  // sqrt(2) / 4.8
static inline wave_float triangle_cdf(wave_float z) {
  z = min(max(z, -1.41421356f), 1.41421356f);
  const wave_float y = fma(z, z, -1.0f);
  wave_float p = fma(y, -0.0128826976f, 0.0300553889f);
  p = fma(y, p, -0.0281423833f);
  p = fma(y, p, 0.0372821587f);
  p = fma(y, p, -0.0733060885f);
  p = fma(y, p, 0.107551745f);
  p = fma(y, p, -0.138188302f);
  p = fma(y, p, 0.179181734f);
  p = fma(y, p, -0.247668429f);
  p = fma(y, p, 0.499663712f);
  return z * p;
}
#else
#define triangle_exp2 gaussian_exp2
#define triangle_cdf gaussian_cdf_centred
#define TRIANGLE_CDF_SCALE CDF_SCALE
#endif

#endif  // MICA_PRECISION_H
