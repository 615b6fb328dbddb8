// Merged elements under a footprint: which records of a level it reaches, and what sixteen elements are for
// it.
#ifndef MICA_PYRAMID_ELEMENTS_H
#define MICA_PYRAMID_ELEMENTS_H

#include "map/map_cull.h"
#include "pyramid/pyramid_types.h"
#include "wave/wave.h"

// Bits of a record's numbers: 16 or 8.
#ifndef MICA_RECORD_BITS
#define MICA_RECORD_BITS 16
#endif
#if MICA_RECORD_BITS == 16
#define RECORD_STRIDE MICA_RECORD_STRIDE_16
#define ELEMENT_FIELD(record, field) \
  wave_to_float(wave_load_short((record) + MICA_RECORD_FIELDS_16 + 16 * (field)))
#else
#define RECORD_STRIDE MICA_RECORD_STRIDE_8
#define ELEMENT_FIELD(record, field) \
  wave_to_float(wave_load_char((global const char*)((record) + MICA_RECORD_FIELDS_8 + 8 * (field))))
#endif

// 1: the half vector turns over the footprint, and the lobe need not be round.
#ifndef MICA_FIRST_ORDER
#define MICA_FIRST_ORDER 0
#endif
#if MICA_FIRST_ORDER
#include "map/turned_lobe.h"
typedef mica_turned_pyramid_query pyramid_query;
#define PYRAMID(query) (&(query)->pyramid)
#else
typedef mica_pyramid_query pyramid_query;
#define PYRAMID(query) (query)
#endif

// Where a group lies: its corner less the footprint's mean, texels.
typedef struct {
  float x, y;
  int index;
} group_place;

// Half vectors that are asked for, in units of bounds: one, or those of an image.
typedef struct {
  float s_low, s_high, t_low, t_high;
} half_vector_box;

static inline int node_word(global const short* node, int word) {
  return ((global const int*)node)[word];
}

// Bits of the children of `node` that reach the cutoff. An element's exponent is at least that of its
// position plus that of its normal, each with the variance that its bound tells added.
static inline uint surviving_records(global const pyramid_query* query, half_vector_box half_vectors,
                                     global const short* node, group_place place, float position_unit,
                                     WAVE_SHARED int* scratch) {
  global const mica_map_query* map = &PYRAMID(query)->map;
  const wave_float x = fma(wave_to_float(wave_load_short(node)), position_unit, place.x);
  const wave_float y = fma(wave_to_float(wave_load_short(node + 32)), position_unit, place.y);
  const wave_float half_width = wave_to_float(wave_load_short(node + 16));
  const wave_float half_height = wave_to_float(wave_load_short(node + 48));
  const float unit_1x = position_unit * fabs(map->whiten_1x), unit_1y = position_unit * fabs(map->whiten_1y);
  const float unit_2x = position_unit * fabs(map->whiten_2x), unit_2y = position_unit * fabs(map->whiten_2y);
  const wave_float p1 = fabs(fma(x, map->whiten_1x, y * map->whiten_1y));
  const wave_float p2 = fabs(fma(x, map->whiten_2x, y * map->whiten_2y));
  const wave_float d1 = max(fma(half_width, -unit_1x, fma(half_height, -unit_1y, p1)), 0.0f);
  const wave_float d2 = max(fma(half_width, -unit_2x, fma(half_height, -unit_2y, p2)), 0.0f);

  const wave_float s_min = wave_to_float(wave_load_short(node + 64)),
                   s_max = wave_to_float(wave_load_short(node + 80));
  const wave_float t_min = wave_to_float(wave_load_short(node + 96)),
                   t_max = wave_to_float(wave_load_short(node + 112));
#if MICA_FIRST_ORDER
  // Normals less what the half vector has turned by at the middle of a box, and by how much more it turns
  // inside.
  const wave_float turned_s = MICA_BOUND_ONE * fma(query->turn_sx, x, query->turn_sy * y);
  const wave_float turned_t = MICA_BOUND_ONE * fma(query->turn_tx, x, query->turn_ty * y);
  const float more = MICA_BOUND_ONE * position_unit;
  const wave_float more_s = more * fma(fabs(query->turn_sx), half_width, fabs(query->turn_sy) * half_height);
  const wave_float more_t = more * fma(fabs(query->turn_tx), half_width, fabs(query->turn_ty) * half_height);
  const wave_float low_s = s_min - turned_s - more_s, high_s = s_max - turned_s + more_s;
  const wave_float low_t = t_min - turned_t - more_t, high_t = t_max - turned_t + more_t;
#else
  const wave_float low_s = s_min, high_s = s_max, low_t = t_min, high_t = t_max;
#endif
  const wave_float d_s = max(max(low_s - half_vectors.s_high, half_vectors.s_low - high_s), 0.0f);
  const wave_float d_t = max(max(low_t - half_vectors.t_high, half_vectors.t_low - high_t), 0.0f);

  const float k = map->inverse_roughness;
  const float node_unit_p = as_float(node_word(node, MICA_PYRAMID_NODE_UNIT_P));
  const float unit_p = PYRAMID(query)->inverse_minor_variance * node_unit_p;
  const float unit_n = k * k * as_float(node_word(node, MICA_PYRAMID_NODE_UNIT_N));
#if MICA_FIRST_ORDER
  // The bound diag(p, n) of an element's covariance becomes one of 2 p and of n + 2 p H H'.
  const wave_float node_p = wave_to_float(wave_load_short(node + 128));
  const wave_float variance_p = fma(node_p, 2.0f * unit_p, 1.0f);
  const wave_float variance_n = fma(wave_to_float(wave_load_short(node + 144)), unit_n,
                                    fma(node_p, node_unit_p * query->spread_turn, 1.0f));
#else
  const wave_float variance_p = fma(wave_to_float(wave_load_short(node + 128)), unit_p, 1.0f);
  const wave_float variance_n = fma(wave_to_float(wave_load_short(node + 144)), unit_n, 1.0f);
#endif
  // q_p / variance_p + q_n / variance_n <= cutoff, without the divisions.
  const wave_float q_p = fma(d1, d1, d2 * d2);
  const wave_float q_n = (k * k / ((float)MICA_BOUND_ONE * MICA_BOUND_ONE)) * fma(d_s, d_s, d_t * d_t);
  const wave_float q = fma(q_p, variance_n, q_n * variance_p);
  return wave_ballot(wave_mask(q <= map->cutoff * variance_p * variance_n) & wave_mask(s_min <= s_max),
                     scratch);
}

// Sixteen elements as the footprint slices them: lobes of normals, in roughnesses.
typedef struct {
  wave_float weight;      // over the square roots of both determinants; without the exponent
  wave_float q_position;  // |.|^2 of the position, whitened
  wave_float r_s, r_t;    // the half vector less the mean
  wave_float n_ss, n_st, n_tt;
  wave_float root;  // 1 / sqrt(det n)
} element_lobes;

#if MICA_FIRST_ORDER
#include "pyramid/turned_elements.h"
#else
// `half_s`, `half_t`: fixed point.
static inline element_lobes slice_record(global const mica_pyramid_query* query, int half_s, int half_t,
                                         global const short* record, group_place place) {
  global const int* int_header = (global const int*)record;
  global const float* header = (global const float*)record;
  const float to_roughness = query->map.inverse_roughness;
  const float offset_s = to_roughness / MICA_NORMAL_ONE * (half_s - int_header[MICA_RECORD_ORIGIN_S]);
  const float offset_t = to_roughness / MICA_NORMAL_ONE * (half_t - int_header[MICA_RECORD_ORIGIN_T]);
  const float mean_unit = -to_roughness * header[MICA_RECORD_MEAN_UNIT];
  const float p_unit = header[MICA_RECORD_POSITION_UNIT];
  const float n_unit = to_roughness * to_roughness * header[MICA_RECORD_NORMAL_UNIT];
  const float k_unit = to_roughness * header[MICA_RECORD_CROSS_UNIT];

  // m - c, and P + F with its adjugate in place of its inverse.
  const float place_unit = -header[MICA_RECORD_PLACE_UNIT];
  const wave_float x =
      fma(ELEMENT_FIELD(record, MICA_ELEMENT_X), place_unit, -(place.x + header[MICA_RECORD_ORIGIN_X]));
  const wave_float y =
      fma(ELEMENT_FIELD(record, MICA_ELEMENT_Y), place_unit, -(place.y + header[MICA_RECORD_ORIGIN_Y]));
  const wave_float p_xx = fma(ELEMENT_FIELD(record, MICA_ELEMENT_XX), p_unit, query->cov_xx);
  const wave_float p_xy = fma(ELEMENT_FIELD(record, MICA_ELEMENT_XY), p_unit, query->cov_xy);
  const wave_float p_yy = fma(ELEMENT_FIELD(record, MICA_ELEMENT_YY), p_unit, query->cov_yy);
  const wave_float root_p = wave_rough_rsqrt(fma(p_xx, p_yy, -(p_xy * p_xy)));
  const wave_float inverse_p = root_p * root_p;
  const wave_float a_x = fma(p_yy, x, -(p_xy * y)), a_y = fma(p_xx, y, -(p_xy * x));

  // The residual of the normal, and its covariance less what the position explains; in roughnesses.
  const wave_float k_sx = ELEMENT_FIELD(record, MICA_ELEMENT_SX),
                   k_sy = ELEMENT_FIELD(record, MICA_ELEMENT_SY);
  const wave_float k_tx = ELEMENT_FIELD(record, MICA_ELEMENT_TX),
                   k_ty = ELEMENT_FIELD(record, MICA_ELEMENT_TY);
  const wave_float k_p = -k_unit * inverse_p, kk_p = k_unit * k_p;
  element_lobes lobes;
  lobes.q_position = inverse_p * fma(x, a_x, y * a_y);
  lobes.r_s =
      fma(k_p, fma(k_sx, a_x, k_sy * a_y), fma(ELEMENT_FIELD(record, MICA_ELEMENT_S), mean_unit, offset_s));
  lobes.r_t =
      fma(k_p, fma(k_tx, a_x, k_ty * a_y), fma(ELEMENT_FIELD(record, MICA_ELEMENT_T), mean_unit, offset_t));
  const wave_float b_sx = fma(p_yy, k_sx, -(p_xy * k_sy)), b_sy = fma(p_xx, k_sy, -(p_xy * k_sx));
  const wave_float b_tx = fma(p_yy, k_tx, -(p_xy * k_ty)), b_ty = fma(p_xx, k_ty, -(p_xy * k_tx));
  lobes.n_ss =
      fma(kk_p, fma(k_sx, b_sx, k_sy * b_sy), fma(ELEMENT_FIELD(record, MICA_ELEMENT_SS), n_unit, 1.0f));
  lobes.n_st = fma(kk_p, fma(k_tx, b_sx, k_ty * b_sy), n_unit * ELEMENT_FIELD(record, MICA_ELEMENT_ST));
  lobes.n_tt =
      fma(kk_p, fma(k_tx, b_tx, k_ty * b_ty), fma(ELEMENT_FIELD(record, MICA_ELEMENT_TT), n_unit, 1.0f));
  lobes.root = wave_rough_rsqrt(fma(lobes.n_ss, lobes.n_tt, -(lobes.n_st * lobes.n_st)));
  lobes.weight =
      ELEMENT_FIELD(record, MICA_ELEMENT_WEIGHT) * header[MICA_RECORD_WEIGHT_UNIT] * root_p * lobes.root;
  return lobes;
}
#endif

static inline int group_of(int i, int size, int groups, int group_size) {
  const int period = floor_divide(i, size);
  return period * groups + (i - period * size) / group_size;
}

static inline group_place place_group(global const mica_map_query* map, mica_map_grid level, int group_size,
                                      int group_x, int group_y) {
  const int period_x = floor_divide(group_x, level.blocks_x),
            period_y = floor_divide(group_y, level.blocks_y);
  const int inside_x = group_x - period_x * level.blocks_x, inside_y = group_y - period_y * level.blocks_y;
  group_place place;
  place.x = (float)(period_x * level.width + inside_x * group_size - map->mean_i) - map->mean_x;
  place.y = (float)(period_y * level.height + inside_y * group_size - map->mean_j) - map->mean_y;
  place.index = inside_y * level.blocks_x + inside_x;
  return place;
}

#endif  // MICA_PYRAMID_ELEMENTS_H
