// The Gaussian lobe that has the mean and the covariance of the slopes under a footprint, from the pyramid of
// slopes. [Che18] sec. 4.2.2
#ifndef MICA_FOOTPRINT_SLOPES_H
#define MICA_FOOTPRINT_SLOPES_H

#include "map/map_cull.h"
#include "types.h"
#include "wave/gaussian.h"
#include "wave/wave.h"

// Standard deviations of the cells' weights within which cells count.
#ifndef MICA_SLOPE_REACH
#define MICA_SLOPE_REACH 4.5f
#endif

// 1: how slopes change with place is summed, too.
#ifndef MICA_FIRST_ORDER
#define MICA_FIRST_ORDER 0
#endif

typedef struct {
  float mean_x, mean_y, xx, xy, yy;
#if MICA_FIRST_ORDER
  float x_i, x_j, y_i, y_j;  // covariances of slopes with the cells' places
#endif
} slope_lobe;

typedef struct {
  wave_float weight, x, y, xx, xy, yy;
#if MICA_FIRST_ORDER
  wave_float i, j, x_i, x_j, y_i, y_j;
#endif
} slope_sums;

static inline int slope_row(global const mica_slope_footprint* at) {
  return at->width + MICA_SLOPE_APRON;
}
static inline int slope_plane(global const mica_slope_footprint* at) {
  return slope_row(at) * (at->height + MICA_SLOPE_APRON);
}

// Adds the 4x4 cells of which the first is (i, j) of the unrolled level. Means count from `origin_x` and
// `origin_y`, in the level's units: those under one footprint, so that no variance is a small difference of
// large squares.
static inline void add_cells(global const mica_slope_footprint* at, global const short* pyramid, int i, int j,
                             float origin_x, float origin_y, private slope_sums* sums) {
  const int row = slope_row(at), plane = slope_plane(at);
  const int inside_i = i - floor_divide(i, at->width) * at->width,
            inside_j = j - floor_divide(j, at->height) * at->height;
  global const short* cell = pyramid + at->offset + inside_j * row + inside_i;
  const wave_float mean_x = at->mean_unit * (wave_to_float(wave_load_short_4x4(cell, row)) - origin_x);
  const wave_float mean_y =
      at->mean_unit * (wave_to_float(wave_load_short_4x4(cell + plane, row)) - origin_y);
  const wave_float a = at->spread_unit * wave_to_float(wave_load_short_4x4(cell + 2 * plane, row));
  const wave_float b = at->spread_unit * wave_to_float(wave_load_short_4x4(cell + 3 * plane, row));
  const wave_float c = at->spread_unit * wave_to_float(wave_load_short_4x4(cell + 4 * plane, row));
  const wave_float x = wave_to_float(i - at->cell_i + (WAVE_LANE & 3)) + (0.5f - at->cell_x);
  const wave_float y = wave_to_float(j - at->cell_j + (WAVE_LANE >> 2)) + (0.5f - at->cell_y);
  const wave_float p1 = (1.0f / at->sigma_x) * fma(-at->shear, y, x), p2 = (1.0f / at->sigma_y) * y;
  const wave_float q = fma(p1, p1, p2 * p2);
  const wave_float weight = gaussian_exp2(max((-EXP2_SCALE * EXP2_SCALE) * q, -126.0f));
  sums->weight += weight;
  sums->x = fma(weight, mean_x, sums->x), sums->y = fma(weight, mean_y, sums->y);
  sums->xx = fma(weight, fma(a, a, mean_x * mean_x), sums->xx);
  sums->xy = fma(weight, fma(a, b, mean_x * mean_y), sums->xy);
  sums->yy = fma(weight, fma(b, b, fma(c, c, mean_y * mean_y)), sums->yy);
#if MICA_FIRST_ORDER
  const wave_float weighted_x = weight * x, weighted_y = weight * y;
  sums->i += weighted_x, sums->j += weighted_y;
  sums->x_i = fma(weighted_x, mean_x, sums->x_i), sums->x_j = fma(weighted_y, mean_x, sums->x_j);
  sums->y_i = fma(weighted_x, mean_y, sums->y_i), sums->y_j = fma(weighted_y, mean_y, sums->y_j);
#endif
}

// Mean and covariance of the slopes under a footprint, without roughness.
static inline slope_lobe footprint_slopes(global const mica_slope_footprint* at, global const short* pyramid,
                                          WAVE_SHARED int* scratch) {
  const wave_float nothing = 0.0f;
  slope_sums sums;
  sums.weight = sums.x = sums.y = sums.xx = sums.xy = sums.yy = nothing;
#if MICA_FIRST_ORDER
  sums.i = sums.j = sums.x_i = sums.x_j = sums.y_i = sums.y_j = nothing;
#endif
  const float reach_x = MICA_SLOPE_REACH * at->sigma_x, reach_y = MICA_SLOPE_REACH * at->sigma_y;
  // Centres of cell n lie at n + 1/2, relative to the mean's whole cell.
  const float mean_x = at->cell_x - 0.5f, mean_y = at->cell_y - 0.5f;
  global const short* own = pyramid + at->offset + at->cell_j * slope_row(at) + at->cell_i;
  const float origin_x = own[0], origin_y = own[slope_plane(at)];
  const int last_j = (int)floor(mean_y + reach_y);
  for (int j = (int)ceil(mean_y - reach_y); j <= last_j; j += 4) {
    const float lean_1 = at->shear * (j - mean_y), lean_2 = at->shear * (min(j + 3, last_j) - mean_y);
    const int last_i = (int)floor(mean_x + reach_x + max(lean_1, lean_2));
    for (int i = (int)ceil(mean_x - reach_x + min(lean_1, lean_2)); i <= last_i; i += 4)
      add_cells(at, pyramid, at->cell_i + i, at->cell_j + j, origin_x, origin_y, &sums);
  }
  const float scale = 1.0f / wave_sum(sums.weight, scratch);
  slope_lobe lobe;
  lobe.mean_x = scale * wave_sum(sums.x, scratch), lobe.mean_y = scale * wave_sum(sums.y, scratch);
  lobe.xx = fma(-lobe.mean_x, lobe.mean_x, scale * wave_sum(sums.xx, scratch));
  lobe.xy = fma(-lobe.mean_x, lobe.mean_y, scale * wave_sum(sums.xy, scratch));
  lobe.yy = fma(-lobe.mean_y, lobe.mean_y, scale * wave_sum(sums.yy, scratch));
#if MICA_FIRST_ORDER
  const float mean_i = scale * wave_sum(sums.i, scratch), mean_j = scale * wave_sum(sums.j, scratch);
  lobe.x_i = fma(-lobe.mean_x, mean_i, scale * wave_sum(sums.x_i, scratch));
  lobe.x_j = fma(-lobe.mean_x, mean_j, scale * wave_sum(sums.x_j, scratch));
  lobe.y_i = fma(-lobe.mean_y, mean_i, scale * wave_sum(sums.y_i, scratch));
  lobe.y_j = fma(-lobe.mean_y, mean_j, scale * wave_sum(sums.y_j, scratch));
#endif
  lobe.mean_x = fma(at->mean_unit, origin_x, lobe.mean_x);
  lobe.mean_y = fma(at->mean_unit, origin_y, lobe.mean_y);
  return lobe;
}

// Node and weight of Gauss and Hermite's rule with four points, n = 0 ... 3, of a normal distribution.
static inline wave_float hermite_node(wave_int n) {
  const wave_float outer = 2.33441422f, inner = 0.741963784f, sign = wave_to_float((n & 1) * 2 - 1);
  return sign * wave_select(inner, outer, wave_mask(n >= 2));
}
static inline wave_float hermite_weight(wave_int n) {
  const wave_float outer = 0.0458758548f, inner = 0.454124145f;
  return wave_select(inner, outer, wave_mask(n >= 2));
}

// The Cholesky factor (x 0; y z) of a lobe's covariance. What rounding leaves of a thin one need not be a
// covariance: |xy| <= sqrt(xx yy) is seen to.
static inline float3 slope_factor(slope_lobe lobe) {
  const float x = sqrt(max(lobe.xx, 1e-20f)), reach = sqrt(max(lobe.yy, 0.0f));
  const float y = min(max(lobe.xy / x, -reach), reach);
  return (float3)(x, y, sqrt(max(fma(-y, y, lobe.yy), 0.0f)));
}

// Adds what a roughness on the disk, 1 / inverse_roughness, spreads the lobe's slopes by: the mean of B B^T
// over them, which is exact for a Gaussian: B B^T is a polynomial of degree six. See lobe.h.
static inline slope_lobe with_roughness(slope_lobe lobe, float inverse_roughness, WAVE_SHARED int* scratch) {
  const float3 factor = slope_factor(lobe);
  const wave_float x = hermite_node(WAVE_LANE & 3), y = hermite_node(WAVE_LANE >> 2);
  const wave_float weight = hermite_weight(WAVE_LANE & 3) * hermite_weight(WAVE_LANE >> 2);
  const wave_float p_x = fma(factor.x, x, lobe.mean_x);
  const wave_float p_y = fma(factor.y, x, fma(factor.z, y, lobe.mean_y));
  const wave_float w = fma(p_x, p_x, fma(p_y, p_y, 1.0f)), k = 1.0f + w;
  const wave_float weighted = weight * w;
  const float variance = 1.0f / (inverse_roughness * inverse_roughness);
  lobe.xx = fma(variance, wave_sum(weighted * fma(k * p_x, p_x, 1.0f), scratch), factor.x * factor.x);
  lobe.xy = fma(variance, wave_sum(weighted * k * p_x * p_y, scratch), factor.x * factor.y);
  lobe.yy = fma(variance, wave_sum(weighted * fma(k * p_y, p_y, 1.0f), scratch),
                fma(factor.y, factor.y, factor.z * factor.z));
  return lobe;
}

#endif  // MICA_FOOTPRINT_SLOPES_H
