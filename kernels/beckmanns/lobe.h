// Sixteen Beckmann lobes of a leaf, one a lane: as they are stored, and their densities. [Che18] Eqs. 2
// and 4.
//
// A lobe is a Gaussian of slopes with mean p and covariance B (S + sigma_r^2 I) B, B = sqrt(w) (I + p p^T), w
// = 1 + |p|^2: B is the derivative of slopes by normals on the disk, so that sigma_r is the roughness there.
// S is stored, as the rows (xx, 0), (yx, yy) of its Cholesky factor; so nothing cancels that is summed below.
#ifndef MICA_LOBE_H
#define MICA_LOBE_H

#include "types.h"
#include "wave/slice.h"
#include "wave/wave.h"

typedef struct {
  wave_float offset_x, offset_y;  // from base to the mean
  wave_float spread_xx, spread_yx, spread_yy;
  float base_x, base_y;
} lobe_leaf;

// Multiplies spreads by `scale`. (What returns a struct would be inlined with a note on its aliases, which
// oclgrind does not know.)
static inline void load_lobes(global const short* leaf, float scale, private lobe_leaf* lobes) {
  global const float* frame = (global const float*)(leaf + 80);
  lobes->base_x = frame[0], lobes->base_y = frame[1];
  lobes->offset_x = frame[2] * wave_to_float(wave_load_short(leaf));
  lobes->offset_y = frame[2] * wave_to_float(wave_load_short(leaf + 16));
  scale *= frame[3];
  lobes->spread_xx = scale * wave_to_float(wave_load_short(leaf + 32));
  lobes->spread_yx = scale * wave_to_float(wave_load_short(leaf + 48));
  lobes->spread_yy = scale * wave_to_float(wave_load_short(leaf + 64));
}

// Sixteen lobes as a half vector meets them, in the slopes' frame of each: B^-1 over the roughness turns its
// slope into normals.
typedef struct {
  wave_float p_x, p_y, d_x, d_y;  // the mean, and the half vector's slope less it
  wave_float inverse_root_w;
  wave_float spread_xx, spread_yx, spread_yy;  // in roughnesses
  wave_float q_position;
} lobe_wave;

// `lobes` has its spreads in roughnesses; `q_position` is times EXP2_SCALE^2.
static inline void meet_lobes(global const mica_lobe_query* query, const private lobe_leaf* lobes,
                              wave_float q_position, private lobe_wave* met) {
  met->p_x = lobes->base_x + lobes->offset_x, met->p_y = lobes->base_y + lobes->offset_y;
  met->d_x = ((query->slope_x - lobes->base_x) + query->slope_rest_x) - lobes->offset_x;
  met->d_y = ((query->slope_y - lobes->base_y) + query->slope_rest_y) - lobes->offset_y;
  met->inverse_root_w = wave_rsqrt(fma(met->p_x, met->p_x, fma(met->p_y, met->p_y, 1.0f)));
  met->spread_xx = lobes->spread_xx, met->spread_yx = lobes->spread_yx, met->spread_yy = lobes->spread_yy;
  met->q_position = q_position;
}

// `weight`: what remains to be multiplied with the slice's density, so that it is one of slopes, times 2 pi
// sigma_r^2.
static inline void slice_lobes(global const mica_lobe_query* query, const private lobe_wave* met,
                               private slice_wave* slice, private wave_float* weight) {
  // B^-1 d / sigma_r
  const wave_float inverse_w = met->inverse_root_w * met->inverse_root_w;
  const wave_float along = inverse_w * fma(met->p_x, met->d_x, met->p_y * met->d_y);
  const wave_float to_roughness = EXP2_SCALE * query->map.inverse_roughness * met->inverse_root_w;
  const wave_float r_x = to_roughness * fma(-along, met->p_x, met->d_x),
                   r_y = to_roughness * fma(-along, met->p_y, met->d_y);
  // I + S / sigma_r^2: its determinant and its inverse's form.
  const wave_float a = met->spread_xx, b = met->spread_yx, c = met->spread_yy, ac = a * c;
  slice->det = fma(a, a, fma(b, b, 1.0f)) + fma(c, c, ac * ac);
  const wave_float cross_1 = fma(r_x, b, -(r_y * a)), cross_2 = r_x * c;
  slice->form = fma(r_x, r_x, r_y * r_y) + fma(cross_1, cross_1, cross_2 * cross_2);
  slice->q_position = met->q_position;
  *weight = inverse_w * inverse_w;
}

// Whitened squared distances of a leaf's elements from the footprint's mean, times EXP2_SCALE^2; its first
// one is (i, j) elements from there. Elements outside of the map, which has room for (room_i, room_j), are
// nowhere.
static inline wave_float lobe_positions(global const mica_map_query* place, int i, int j, int room_i,
                                        int room_j) {
  const wave_float x = wave_to_float(i + (WAVE_LANE & 3)) - (place->mean_x - 0.5f);
  const wave_float y = wave_to_float(j + (WAVE_LANE >> 2)) - (place->mean_y - 0.5f);
  const wave_float p1 = EXP2_SCALE * fma(x, place->whiten_1x, y * place->whiten_1y);
  const wave_float p2 = EXP2_SCALE * fma(x, place->whiten_2x, y * place->whiten_2y);
  const wave_float nowhere = NOWHERE, q = fma(p1, p1, p2 * p2);
  if (room_i >= MICA_LEAF && room_j >= MICA_LEAF) return q;
  return wave_select(nowhere, q, wave_mask((WAVE_LANE & 3) < room_i) & wave_mask((WAVE_LANE >> 2) < room_j));
}

#endif  // MICA_LOBE_H
