// What a query whose half vector turns over its footprint, and whose lobe need not be round, asks of normals.
#ifndef MICA_TURNED_LOBE_H
#define MICA_TURNED_LOBE_H

#include "map/map_cull.h"
#include "types.h"
#include "wave/wave.h"

// Whitens normals less the half vector, (s, t), at (x, y) texels from the footprint's mean.
static inline void whiten_normals(global const mica_turned_lobe* lobe, wave_float x, wave_float y,
                                  private wave_float* s, private wave_float* t) {
  const wave_float a = *s, b = *t;
  *s = fma(-lobe->turn_1x, x, fma(-lobe->turn_1y, y, fma(lobe->lobe_1s, a, lobe->lobe_1t * b)));
  *t = fma(-lobe->turn_2x, x, fma(-lobe->turn_2y, y, fma(lobe->lobe_2s, a, lobe->lobe_2t * b)));
}

// Lower bound of their squared length over squares whose lower left corner lies (x, y) texels from the mean,
// where normals less the half vector are at most (half_s, half_t) from (s, t).
static inline wave_float lobe_bound(global const mica_turned_lobe* lobe, wave_float s, wave_float t,
                                    wave_float half_s, wave_float half_t, wave_float x, wave_float y,
                                    float size) {
  whiten_normals(lobe, x + 0.5f * size, y + 0.5f * size, &s, &t);
  const float turn_1 = 0.5f * size * (fabs(lobe->turn_1x) + fabs(lobe->turn_1y));
  const float turn_2 = 0.5f * size * (fabs(lobe->turn_2x) + fabs(lobe->turn_2y));
  const wave_float r_1 = fma(fabs(lobe->lobe_1s), half_s, fma(fabs(lobe->lobe_1t), half_t, turn_1));
  const wave_float r_2 = fma(fabs(lobe->lobe_2s), half_s, fma(fabs(lobe->lobe_2t), half_t, turn_2));
  const wave_float d_1 = max(fabs(s) - r_1, 0.0f), d_2 = max(fabs(t) - r_2, 0.0f);
  return fma(d_1, d_1, d_2 * d_2);
}

// As surviving_children.
static inline uint turned_children(global const mica_turned_query* query, global const short* node, int i,
                                   int j, int child_size, WAVE_SHARED int* scratch) {
  const wave_float s_min = wave_to_float(wave_load_short(node));
  const wave_float s_max = wave_to_float(wave_load_short(node + 16));
  const wave_float t_min = wave_to_float(wave_load_short(node + 32));
  const wave_float t_max = wave_to_float(wave_load_short(node + 48));
  const float unit = 1.0f / MICA_BOUND_ONE, half_unit = 0.5f / MICA_BOUND_ONE;
  const float h_s = query->map.half_s * (1.0f / MICA_NORMAL_ONE),
              h_t = query->map.half_t * (1.0f / MICA_NORMAL_ONE);
  const wave_float x = wave_to_float(i + (WAVE_LANE & 3) * child_size) - query->map.mean_x;
  const wave_float y = wave_to_float(j + (WAVE_LANE >> 2) * child_size) - query->map.mean_y;
  const wave_float q_normal =
      lobe_bound(&query->lobe, half_unit * (s_min + s_max) - h_s, half_unit * (t_min + t_max) - h_t,
                 half_unit * (s_max - s_min) + 0.01f * unit, half_unit * (t_max - t_min) + 0.01f * unit, x, y,
                 (float)child_size);
  const wave_float q = q_normal + footprint_bound(&query->map, x, y, (float)child_size);
  return wave_ballot(wave_mask(q <= query->map.cutoff) & wave_mask(s_min <= s_max), scratch);
}

#endif  // MICA_TURNED_LOBE_H
