// Areas of lobes that a direction sees: the integral of <o, w> D(w), [Che18] Eqs. 11-13, in closed form.
//
// <o, w> / (w.g) is o_z - p.o_xy at slope p where that is positive. Over a lobe it is normal with mean m and
// standard deviation t, and the mean of its positive part is m + t (phi(m / t) - (m / t) Phi(-m / t)): the
// projected area of the mean normal, and what hides behind the rest.
#ifndef MICA_VISIBLE_AREA_H
#define MICA_VISIBLE_AREA_H

#include "wave/gaussian.h"
#include "wave/wave.h"

// What is added to m; from -m (all hidden) to 0 (m / t large). @param variance t^2, a normal number.
static inline wave_float hidden_area(wave_float m, wave_float variance) {
  const wave_float inverse_t = wave_rsqrt(variance), z = m * inverse_t, t = variance * inverse_t;
  const wave_float density = 0.398942280f * gaussian_exp2(max((-EXP2_SCALE * EXP2_SCALE) * z * z, -126.0f));
  const wave_float tail = 0.5f - gaussian_cdf_centred(CDF_SCALE * z);
  return fma(t, density, -(m * tail));
}

#endif  // MICA_VISIBLE_AREA_H
