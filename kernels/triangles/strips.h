// The Gaussian over quads that are thin beside it one way: one integral in closed form, one by few points,
// and nothing is whitened.
#ifndef MICA_STRIPS_H
#define MICA_STRIPS_H

#include "triangles/precision.h"
#include "triangles/residual.h"

// One affine map of a quad, for integrals along its second edge in closed form: with R(x, y) = r0 + x m1 + y
// m2, Q/2 is -log(2) (e0 + x (e1 + x e2)) off the direction of m2, and b0 + x b1 + y length along it, in the
// scale of triangle_cdf.
typedef struct {
  wave_float e0, e1, e2, b0, b1, length;
  wave_float weight;  // 1 / |m2|
} strip;

static inline strip make_strip(affine_residual r) {
  strip result;
  const wave_float a22 = max(dot4(r.m2, r.m2), 1e-4f);
  result.weight = wave_rsqrt(a22);
  const wave_float b0 = dot4(r.r0, r.m2) * result.weight, b1 = dot4(r.m1, r.m2) * result.weight;
  const residual r0 = subtract(r.r0, b0 * result.weight, r.m2), m1 = subtract(r.m1, b1 * result.weight, r.m2);
  result.e0 = MINUS_HALF_LOG2_E * dot4(r0, r0), result.e1 = (2.0f * MINUS_HALF_LOG2_E) * dot4(r0, m1);
  result.e2 = MINUS_HALF_LOG2_E * dot4(m1, m1);
  result.b0 = TRIANGLE_CDF_SCALE * b0, result.b1 = TRIANGLE_CDF_SCALE * b1;
  result.length = TRIANGLE_CDF_SCALE * a22 * result.weight;
  return result;
}

// Integral of exp(-Q/2) at x over y from 0 to `to`, over sqrt(2 pi).
static inline wave_float integrate_strip(strip s, float x, float to) {
  const wave_float e = fma(fma(s.e2, x, s.e1), x, s.e0), z = fma(s.b1, x, s.b0);
  const wave_float inside = triangle_cdf(fma(s.length, to, z)) - triangle_cdf(z);
  return triangle_exp2(min(max(e, -126.0f), 0.0f)) * inside * s.weight;
}

// Both triangles of quads whose first edges are at most `longest`: along these by Gauss-Legendre, along the
// second ones in closed form. The triangles meet in the diagonal, so what is left to the points is as smooth
// as the first edges are short, however steep the second ones.
static inline wave_float integrate_strips(affine_residual lower, affine_residual upper, float longest) {
  const strip l = make_strip(lower), u = make_strip(upper);
  int count;
  const int first = strip_rule(longest, &count);
  wave_float sum = 0.0f;
  for (int k = first; k < first + count; ++k) {
    const float x = fma(0.5f, legendre_nodes[k], 0.5f);
    sum = fma(legendre_weights[k], integrate_strip(l, x, 1.0f - x) + integrate_strip(u, 1.0f - x, x), sum);
  }
  return COUNTED(140 + STRIP_FLOPS * count, (0.5f * 2.5066283f) * sum);
}

static inline residual choose(residual otherwise, residual chosen, wave_int mask) {
  residual r;
  r.p1 = wave_select(otherwise.p1, chosen.p1, mask), r.p2 = wave_select(otherwise.p2, chosen.p2, mask);
  r.s = wave_select(otherwise.s, chosen.s, mask), r.t = wave_select(otherwise.t, chosen.t, mask);
  return r;
}

// The triangle with its legs exchanged where `mask` is set.
static inline affine_residual swap_legs(affine_residual r, wave_int mask) {
  affine_residual result;
  result.r0 = r.r0, result.m1 = choose(r.m1, r.m2, mask), result.m2 = choose(r.m2, r.m1, mask);
  return result;
}

#endif  // MICA_STRIPS_H
