// Sixteen Beckmann lobes of a leaf, one a lane: as they are stored, and their densities. [Che18] Eqs. 2 and 4.
//
// A lobe is a Gaussian of slopes with mean p and covariance B (S + sigma_r^2 I) B, B = sqrt(w) (I + p p^T), w = 1 + |p|^2:
// B is the derivative of slopes by normals on the disk, so that sigma_r is the roughness there. S is stored, as the rows
// (xx, 0), (yx, yy) of its Cholesky factor; so nothing cancels that is summed below.
#ifndef MICA_LOBE_H
#define MICA_LOBE_H

#include "gaussian.h"
#include "types.h"
#include "wave.h"

typedef struct {
  wave_float offset_x, offset_y;        // of the mean from base
  wave_float spread_xx, spread_yx, spread_yy;
  float base_x, base_y;
} lobe_leaf;

// Multiplies spreads by `scale`. (What returns a struct would be inlined with a note on its aliases, which oclgrind does not
// know.)
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

// Densities of slopes at the query's half vector, times 2 pi sigma_r^2, times exp(-q_position / 2). `lobes` has its spreads
// in roughnesses.
static inline wave_float lobe_densities(global const mica_lobe_query* query, const private lobe_leaf* lobes,
                                        wave_float q_position) {
  const wave_float p_x = lobes->base_x + lobes->offset_x, p_y = lobes->base_y + lobes->offset_y;
  const wave_float d_x = ((query->slope_x - lobes->base_x) + query->slope_rest_x) - lobes->offset_x;
  const wave_float d_y = ((query->slope_y - lobes->base_y) + query->slope_rest_y) - lobes->offset_y;
  // B^-1 d / sigma_r
  const wave_float inverse_root_w = wave_rsqrt(fma(p_x, p_x, fma(p_y, p_y, 1.0f)));
  const wave_float inverse_w = inverse_root_w * inverse_root_w;
  const wave_float along = inverse_w * fma(p_x, d_x, p_y * d_y);
  const wave_float to_roughness = query->map.inverse_roughness * inverse_root_w;
  const wave_float r_x = to_roughness * fma(-along, p_x, d_x), r_y = to_roughness * fma(-along, p_y, d_y);
  // I + S / sigma_r^2: its determinant and its inverse's form.
  const wave_float a = lobes->spread_xx, b = lobes->spread_yx, c = lobes->spread_yy, ac = a * c;
  const wave_float det = fma(a, a, fma(b, b, fma(c, c, fma(ac, ac, 1.0f))));
  const wave_float cross_1 = fma(r_x, b, -(r_y * a)), cross_2 = r_x * c;
  const wave_float form = fma(r_x, r_x, fma(r_y, r_y, fma(cross_1, cross_1, cross_2 * cross_2)));
  const wave_float inverse_root = wave_rsqrt(det);
  const wave_float q = fma(form * inverse_root, inverse_root, q_position);
  return inverse_w * inverse_w * inverse_root * gaussian_exp2(max((-EXP2_SCALE * EXP2_SCALE) * q, -126.0f));
}

// Whitened squared distances of a leaf's elements from the footprint's mean; its first one is (i, j) elements from there.
static inline wave_float lobe_positions(global const mica_map_query* place, int i, int j) {
  const wave_float x = wave_to_float(i + (WAVE_LANE & 3)) - (place->mean_x - 0.5f);
  const wave_float y = wave_to_float(j + (WAVE_LANE >> 2)) - (place->mean_y - 0.5f);
  const wave_float p1 = fma(x, place->whiten_1x, y * place->whiten_1y);
  const wave_float p2 = fma(x, place->whiten_2x, y * place->whiten_2y);
  return fma(p1, p1, p2 * p2);
}

#endif  // MICA_LOBE_H
