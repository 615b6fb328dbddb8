// A half vector that turns over the footprint, and lobes of glints that are not round. Ours: [Kem25] holds
// the half vector constant.
//
// On the unit square a glint at the place d sees the half vector at a + A d, with the footprint's covariance
// C. The expectation of those beyond the cells takes the lobe S widened to S + A C A^T, which has a
// correlation even where S has none.
#ifndef MICA_GLINT_TURN_H
#define MICA_GLINT_TURN_H

#include "grid/glint_maps.h"
#include "types.h"
#include "wave/quadrature.h"
#include "wave/wave.h"

#ifndef MICA_FIRST_ORDER
#define MICA_FIRST_ORDER 0
#endif

#define GLINT_FLOAT(name) wave_load_float((global const float*)(fields + (name)*pitch + first))
#define GLINT_INT(name) wave_load_int(fields + (name)*pitch + first)

// As MICA_GLINT_LOBE_SHEAR and those after it.
typedef struct {
  wave_float shear;
  wave_float a1, a2, b1, b2;
  wave_float spread_a, spread_b, tangent;
} glint_turn;

static inline glint_turn load_turn(global const int* fields, int pitch, int first) {
  glint_turn turn;
  turn.shear = GLINT_FLOAT(MICA_GLINT_LOBE_SHEAR);
  turn.a1 = GLINT_FLOAT(MICA_GLINT_TURN_A1), turn.a2 = GLINT_FLOAT(MICA_GLINT_TURN_A2);
  turn.b1 = GLINT_FLOAT(MICA_GLINT_TURN_B1), turn.b2 = GLINT_FLOAT(MICA_GLINT_TURN_B2);
  turn.spread_a = GLINT_FLOAT(MICA_GLINT_SPREAD_A), turn.spread_b = GLINT_FLOAT(MICA_GLINT_SPREAD_B);
  turn.tangent = GLINT_FLOAT(MICA_GLINT_SPREAD_TANGENT);
  return turn;
}

// e^(-r / 2) at the angle of a correlation with the given square of its cosine and 1 / (1 + its sine): r is
// the squared distance of a corner (h, k) from the middle, ((h - k)^2 / cos^2 + 2 h k / (1 + sin)).
static inline wave_float corner_density(wave_float h, wave_float k, wave_float inverse_cos2,
                                        wave_float inverse_sin) {
  return exp_minus(max(fma(0.5f * (h - k) * (h - k), inverse_cos2, h * k * inverse_sin), 0.0f));
}

// What a rectangle has more of two normal variables than it would have were they independent: the integral of
// their density at its corners over the arcsine of the correlation [Drezner, Wesolowsky 1990], by eight
// points over the tangent of its half. Ends in standard deviations; absolute error 1e-7 to a correlation of
// 0.95, 1e-5 to 0.99.
static inline wave_float share_by_correlation(wave_float low_a, wave_float high_a, wave_float low_b,
                                              wave_float high_b, wave_float tangent) {
  const wave_float one = 1.0f, minus = -1.0f, zero = 0.0f;
  const wave_float sign = wave_select(one, minus, wave_mask(tangent < 0.0f)), whole = fabs(tangent);
  const wave_float k_low = sign * low_b, k_high = sign * high_b;
  wave_float sum = zero;
  for (int n = 27; n < 35; ++n) {  // the rule of eight points
    const wave_float t = whole * fma(0.5f, legendre_nodes[n], 0.5f), t2 = t * t;
    const wave_float inverse =
        wave_reciprocal(1.0f + t2);  // sin = 2 t / (1 + t^2), cos = (1 - t^2) / (1 + t^2)
    const wave_float inverse_cos = (1.0f + t2) * wave_reciprocal(1.0f - t2);
    const wave_float inverse_cos2 = inverse_cos * inverse_cos;
    const wave_float inverse_sin = (1.0f + t2) * wave_reciprocal((1.0f + t) * (1.0f + t));
    const wave_float corners = corner_density(low_a, k_low, inverse_cos2, inverse_sin) -
                               corner_density(low_a, k_high, inverse_cos2, inverse_sin) +
                               corner_density(high_a, k_high, inverse_cos2, inverse_sin) -
                               corner_density(high_a, k_low, inverse_cos2, inverse_sin);
    sum = fma(legendre_weights[n] * inverse, corners, sum);
  }
  return INVERSE_TWO_PI * tangent * sum;
}

#endif  // MICA_GLINT_TURN_H
