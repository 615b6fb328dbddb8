// The maps T between half vectors and the disk U on which glints are uniform. [Kem25] sec. 3.2.
//
// U is inscribed in the unit square. Both maps keep areas: a patch of the disk of half vectors (s, t) that
// holds a share of D's integral covers that share of U, |dT / d(s, t)| = |U| D (Eq. 3). For Trowbridge-Reitz
// this takes the orthographic projection where Eq. 7 has Lambert's: D is normalised over projected solid
// angle, which Lambert's does not keep.
#ifndef MICA_GLINT_MAPS_H
#define MICA_GLINT_MAPS_H

#include "wave/wave.h"

// 0: Beckmann, 1: Trowbridge-Reitz (GGX).
#ifndef MICA_DISTRIBUTION
#define MICA_DISTRIBUTION 1
#endif

#define INVERSE_PI 0.318309886f
#define INVERSE_TWO_PI 0.159154943f
#define GLINT_DISK_AREA 0.785398163f  // |U|

// A point of the unit square, and the smooth density D(h) per area of the disk of half vectors. D is zero off
// that disk.
typedef struct {
  wave_float x, y, density;
} glint_disk_point;

// e^-x for x >= 0, relative error 1e-7; 1e-38 from x = 87 on.
static inline wave_float exp_minus(wave_float x) {
  const wave_float power = max(-1.44269504f * x, -126.0f);
  const wave_float shifted = power + 12582912.0f;  // 1.5 * 2^23: the sum's low bits are round(power)
  const wave_float f = power - (shifted - 12582912.0f);
  wave_float p = fma(f, 0.00015345811f, 0.00133999309f);
  p = fma(f, p, 0.00961848907f);
  p = fma(f, p, 0.0555032864f);
  p = fma(f, p, 0.240226462f);
  p = fma(f, p, 0.693147182f);
  p = fma(f, p, 1.0f);
  return wave_from_bits(wave_bits_of(p) + (wave_bits_of(shifted) << 23));
}

// (1 - e^-x) / x for x >= 0, given e^-x; by its polynomial where the difference would cancel.
static inline wave_float mean_of_exp_minus(wave_float x, wave_float exp_minus_x) {
  const wave_float z = min(x, 1.0f);
  wave_float p = fma(z, 0.000128380692f, -0.00129866367f);
  p = fma(z, p, 0.00827309582f);
  p = fma(z, p, -0.041645579f);
  p = fma(z, p, 0.166663095f);
  p = fma(z, p, -0.499999762f);
  p = fma(z, p, 1.0f);
  return wave_select(p, (1.0f - exp_minus_x) * wave_reciprocal(max(x, 1.0f)), wave_mask(x > 1.0f));
}

static inline glint_disk_point glint_to_disk(wave_float s, wave_float t, wave_float inverse_alpha_x,
                                             wave_float inverse_alpha_y) {
  const wave_float cos2 = 1.0f - fma(s, s, t * t);  // squared cosine of the angle from the surface's normal
  const wave_float x = s * inverse_alpha_x, y = t * inverse_alpha_y;
  const wave_float scale = INVERSE_PI * inverse_alpha_x * inverse_alpha_y, zero = 0.0f;
  wave_float stretch, density;
#if MICA_DISTRIBUTION == 0
  const wave_float inverse_cos = wave_rsqrt(max(cos2, 1e-12f));
  const wave_float inverse_cos2 = inverse_cos * inverse_cos;
  const wave_float slope2 = fma(x, x, y * y) * inverse_cos2;
  const wave_float e = exp_minus(slope2);
  const wave_float mean = mean_of_exp_minus(slope2, e);
  stretch = mean * wave_rsqrt(max(mean, 1e-30f)) * inverse_cos;  // B_1^-1 after B_2^-1
  density = scale * e * inverse_cos2 * inverse_cos2;
#else
  const wave_float length2 = fma(x, x, fma(y, y, max(cos2, 0.0f)));  // squared length of M^T h, Eq. 6
  stretch = wave_rsqrt(length2);
  const wave_float inverse_length2 = stretch * stretch;
  density = scale * inverse_length2 * inverse_length2;
#endif
  glint_disk_point result;
  result.x = fma(0.5f * x, stretch, 0.5f), result.y = fma(0.5f * y, stretch, 0.5f);
  result.density = wave_select(zero, density, wave_mask(cos2 > 0.0f));
  return result;
}

// T^-1: (s, t) of a point of the unit square; points outside of U go to its rim.
static inline void glint_from_disk(wave_float x, wave_float y, wave_float alpha_x, wave_float alpha_y,
                                   private wave_float* s, private wave_float* t) {
  const wave_float u = fma(2.0f, x, -1.0f), v = fma(2.0f, y, -1.0f),
                   radius2 = min(fma(u, u, v * v), 0.99999994f);
#if MICA_DISTRIBUTION == 0
  const wave_float slope2 = -log1p(-radius2);  // [Kem25] B_1
  const wave_float stretch =
      wave_select(slope2 / max(radius2, 1e-30f), 1.0f + 0.5f * radius2, wave_mask(radius2 < 1e-6f));
  const wave_float m = sqrt(stretch), z = 1.0f;
#else
  const wave_float m = 1.0f, z = sqrt(1.0f - radius2);
#endif
  const wave_float a = u * alpha_x * m, b = v * alpha_y * m;
  const wave_float inverse_length = rsqrt(fma(a, a, fma(b, b, z * z)));
  *s = a * inverse_length, *t = b * inverse_length;
}

#endif  // MICA_GLINT_MAPS_H
