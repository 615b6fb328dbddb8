// The normals at the corners of a leaf's sixteen quads, one quad a lane, in fixed point.
#ifndef MICA_QUAD_CORNERS_H
#define MICA_QUAD_CORNERS_H

#include "types.h"
#include "wave/wave.h"

// 0: constant texels, whose corners are all the same; else quads between the centres of texels.
#ifndef MICA_INTERPOLATION
#define MICA_INTERPOLATION 1
#endif

typedef struct {
  wave_int s00, s10, s01, s11, t00, t10, t01, t11;
} quad_corners;

// @param at where the leaf's lower left texel is stored.
static inline void load_corners(global const int* normals, int at, private quad_corners* c) {
  global const int* s = normals + at;
  global const int* t = s + MICA_BLOCK_PLANE;
#if MICA_INTERPOLATION == 0
  c->s00 = wave_load_4x4(s, MICA_BLOCK_ROW), c->t00 = wave_load_4x4(t, MICA_BLOCK_ROW);
  c->s10 = c->s01 = c->s11 = c->s00, c->t10 = c->t01 = c->t11 = c->t00;
#else
  wave_load_quads(s, MICA_BLOCK_ROW, &c->s00, &c->s10, &c->s01, &c->s11);
  wave_load_quads(t, MICA_BLOCK_ROW, &c->t00, &c->t10, &c->t01, &c->t11);
#endif
}

#endif  // MICA_QUAD_CORNERS_H
