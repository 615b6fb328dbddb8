// The 4-vector R whose squared length is the exponent of a footprint times a lobe, on a triangle.
#ifndef MICA_RESIDUAL_H
#define MICA_RESIDUAL_H

#include "wave/wave.h"

// R, or a difference of two: position in standard deviations of the footprint (1, 2: its axes), normal in
// standard deviations of roughness (s, t).
typedef struct {
  wave_float p1, p2, s, t;
} residual;

// R(corner + x e1 + y e2) = r0 + x m1 + y m2, for the legs e1, e2 of a right triangle.
typedef struct {
  residual r0, m1, m2;
} affine_residual;

static inline wave_float dot4(residual a, residual b) {
  return fma(a.t, b.t, fma(a.s, b.s, fma(a.p2, b.p2, a.p1 * b.p1)));
}

// a - k b
static inline residual subtract(residual a, wave_float k, residual b) {
  residual r;
  r.p1 = fma(-k, b.p1, a.p1);
  r.p2 = fma(-k, b.p2, a.p2);
  r.s = fma(-k, b.s, a.s);
  r.t = fma(-k, b.t, a.t);
  return r;
}

#endif  // MICA_RESIDUAL_H
