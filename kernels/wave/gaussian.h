// The two special functions of the P-NDF kernels, as plain multiply-add chains that vectorise on every
// device.
#ifndef MICA_GAUSSIAN_H
#define MICA_GAUSSIAN_H

#include "wave/wave.h"

// 2^x for -126 <= x <= 0, relative error 3e-6.
static inline wave_float gaussian_exp2(wave_float x) {
  const wave_float shifted = x + 12582912.0f;  // 1.5 * 2^23: the sum's low bits are round(x)
  const wave_float f = x - (shifted - 12582912.0f);
  wave_float p = fma(f, 0.00957010128f, 0.0559178628f);
  p = fma(f, p, 0.240247443f);
  p = fma(f, p, 0.693121791f);
  p = fma(f, p, 0.999999285f);
  return wave_from_bits(wave_bits_of(p) + (wave_bits_of(shifted) << 23));
}

// exp(-q / 2) = gaussian_exp2(-(EXP2_SCALE^2) q)
#define EXP2_SCALE 0.84932180f  // sqrt(log2(e) / 2)

// Phi(x) - 1/2 of the standard normal distribution at x = z / CDF_SCALE, absolute error 1.5e-7; odd, and
// exactly constant for |x| >= 5.4.
#define CDF_SCALE 0.26189140f  // sqrt(2) / 5.4: z^2 - 1 runs over [-1, 1] where x runs over [0, 5.4]
static inline wave_float gaussian_cdf_centred(wave_float z) {
  z = min(max(z, -1.41421356f), 1.41421356f);
  const wave_float y = fma(z, z, -1.0f);
  wave_float p = fma(y, -0.000637984369f, 0.00175452f);
  p = fma(y, p, -0.00166180276f);
  p = fma(y, p, 0.00251409551f);
  p = fma(y, p, -0.00773620466f);
  p = fma(y, p, 0.0150201758f);
  p = fma(y, p, -0.0233387481f);
  p = fma(y, p, 0.0361964628f);
  p = fma(y, p, -0.0541995615f);
  p = fma(y, p, 0.0752210319f);
  p = fma(y, p, -0.0981369242f);
  p = fma(y, p, 0.122602001f);
  p = fma(y, p, -0.149721205f);
  p = fma(y, p, 0.185191438f);
  p = fma(y, p, -0.24944675f);
  p = fma(y, p, 0.499932826f);
  return z * p;
}

#endif  // MICA_GAUSSIAN_H
