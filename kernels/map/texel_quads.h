// Included by triangles.cl: the leaf of a map with constant or bilinear texels, one quad a lane.
#ifndef MICA_TEXEL_QUADS_H
#define MICA_TEXEL_QUADS_H

#include "map/quad_corners.h"

// Distance of a fixed-point value from the interval that four others span.
static inline wave_float distance_from(int value, wave_int a, wave_int b, wave_int c, wave_int d) {
  const wave_int low = min(min(a, b), min(c, d)), high = max(max(a, b), max(c, d));
  const wave_int zero = 0;
  return wave_to_float(max(max(low - value, value - high), zero));
}

// The sixteen quads of a leaf, whose lower left texel is stored at `at` and lies (i, j) texels from the mean;
// `room_i`, `room_j` are the texels that the map has left there.
static inline void take_leaf(global const triangle_query* query, global const int* normals, int at, int i,
                             int j, int room_i, int room_j, private waiting_quads* waiting,
                             private integrator* out, WAVE_SHARED int* scratch) {
  quad_corners c;
  load_corners(normals, at, &c);
  global const mica_map_query* place = PLACE(query);
  const int h_s = place->half_s, h_t = place->half_t;
  const wave_int column = WAVE_LANE & 3, row = WAVE_LANE >> 2;
  const wave_int inside_map = wave_mask(column < room_i) & wave_mask(row < room_j);
  quads q;
  q.x = wave_to_float(i + column) - place->mean_x, q.y = wave_to_float(j + row) - place->mean_y;
#if MICA_FIRST_ORDER
  const float scale = 1.0f / MICA_NORMAL_ONE;
#else
  const float scale = place->inverse_roughness / MICA_NORMAL_ONE;
  const wave_float d_s = scale * distance_from(h_s, c.s00, c.s10, c.s01, c.s11);
  const wave_float d_t = scale * distance_from(h_t, c.t00, c.t10, c.t01, c.t11);
  const wave_float bound = fma(d_s, d_s, fma(d_t, d_t, footprint_bound(place, q.x, q.y, QUAD_SIZE)));
  const uint bits = wave_ballot(wave_mask(bound <= place->cutoff) & inside_map, scratch);
  if (bits == 0) return;
#endif
  // Exact differences of fixed-point numbers: rounding begins here.
  q.s00 = scale * wave_to_float(c.s00 - h_s), q.t00 = scale * wave_to_float(c.t00 - h_t);
  q.s10 = scale * wave_to_float(c.s10 - h_s), q.t10 = scale * wave_to_float(c.t10 - h_t);
  q.s01 = scale * wave_to_float(c.s01 - h_s), q.t01 = scale * wave_to_float(c.t01 - h_t);
  q.s11 = scale * wave_to_float(c.s11 - h_s), q.t11 = scale * wave_to_float(c.t11 - h_t);
#if MICA_FIRST_ORDER
  whiten_quads(query, &q);
  const wave_float bound = quads_bound(place, &q);
  const uint bits = wave_ballot(wave_mask(bound <= place->cutoff) & inside_map, scratch);
  if (bits == 0) return;
#endif
  take_quads(place, &q, bits, waiting, out, scratch);
}

#endif  // MICA_TEXEL_QUADS_H
