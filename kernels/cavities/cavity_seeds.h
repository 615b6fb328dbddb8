// Included by kernels on a map of V-shaped cavities: the seeds of a leaf, MICA_SEEDS x MICA_SEEDS a texel.
// [Che19] Eq. 16
#ifndef MICA_CAVITY_SEEDS_H
#define MICA_CAVITY_SEEDS_H

#include "types.h"
#include "wave/wave.h"

// 0: constant texels, with seeds inside them; else seeds at the centres of texels and on the bilinear quads
// between them.
#ifndef MICA_INTERPOLATION
#define MICA_INTERPOLATION 1
#endif
// Seeds a texel and axis: 1 or 2.
#ifndef MICA_SEEDS
#define MICA_SEEDS 1
#endif
#define SEED_SPACING (1.0f / MICA_SEEDS)
#define SEED_FIRST (MICA_INTERPOLATION == 0 ? 0.5f * SEED_SPACING : 0.0f)  // from the texel's place, texels

// One component of seed (a, b) of sixteen texels whose values begin at `values`, in fixed point.
static inline wave_int seed_normals(global const int* values, int a, int b) {
  if (MICA_INTERPOLATION == 0 || (a == 0 && b == 0)) return wave_load_4x4(values, MICA_BLOCK_ROW);
  global const int* across = values + a;
  global const int* up = values + b * MICA_BLOCK_ROW;
  if (a == 0 || b == 0) {
    global const int* next = a ? across : up;
    return (wave_load_4x4(values, MICA_BLOCK_ROW) >> 1) + (wave_load_4x4(next, MICA_BLOCK_ROW) >> 1);
  }
  return (wave_load_4x4(values, MICA_BLOCK_ROW) >> 2) + (wave_load_4x4(across, MICA_BLOCK_ROW) >> 2) +
         (wave_load_4x4(up, MICA_BLOCK_ROW) >> 2) + (wave_load_4x4(up + a, MICA_BLOCK_ROW) >> 2);
}

// Whitened squared distances from the footprint's mean of points (x, y) texels from the mean's whole texel.
static inline wave_float seed_distances(global const mica_map_query* place, wave_float x, wave_float y) {
  x -= place->mean_x, y -= place->mean_y;
  const wave_float p1 = fma(x, place->whiten_1x, y * place->whiten_1y);
  const wave_float p2 = fma(x, place->whiten_2x, y * place->whiten_2y);
  return fma(p1, p1, p2 * p2);
}

#endif  // MICA_CAVITY_SEEDS_H
