// `pyramid`: the P-NDF of a footprint on merged elements. A level cuts the map into blocks and the normals into cells, and
// has one 4D Gaussian in (position, normal) for each block and cell that is not empty: weight w, mean (c, n), covariance
//     | P    K^T |
//     | K    N   |.
// With m and F the footprint's mean and covariance, h the half vector, its share of D is exactly
//     w N(m - c; P + F) N(h - n - K A (m - c); N + sigma_r^2 I - K A K^T),   A = (P + F)^-1.
// One wave a query: boxes of sixteen children are tested at a time, and sixteen elements summed at a time.

#include "gaussian.h"
#include "map_cull.h"
#include "pyramid_types.h"
#include "wave.h"

// 1: the sum becomes the number of elements that were evaluated, for benchmarks.
#ifndef MICA_COUNT_ELEMENTS
#define MICA_COUNT_ELEMENTS 0
#endif

// Where a group lies: its corner less the footprint's mean, texels.
typedef struct {
  float x, y;
  int index;
} group_place;

static inline int node_word(global const short* node, int word) { return ((global const int*)node)[word]; }

// Bits of the children of `node` that reach the cutoff. A joint covariance is at most twice its two diagonal blocks, so that
// an element's exponent is at least that of its position plus that of its normal, each with twice its variance added.
static inline uint surviving_records(global const mica_pyramid_query* query, global const short* node, group_place place,
                                     float position_unit, WAVE_SHARED int* scratch) {
  global const mica_map_query* map = &query->map;
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

  const float to_bound = (float)MICA_BOUND_ONE / MICA_NORMAL_ONE;
  const float h_s = map->half_s * to_bound, h_t = map->half_t * to_bound;
  const wave_float s_min = wave_to_float(wave_load_short(node + 64)), s_max = wave_to_float(wave_load_short(node + 80));
  const wave_float t_min = wave_to_float(wave_load_short(node + 96)), t_max = wave_to_float(wave_load_short(node + 112));
  const wave_float d_s = max(max(s_min - h_s, h_s - s_max), 0.0f);
  const wave_float d_t = max(max(t_min - h_t, h_t - t_max), 0.0f);

  const float k = map->inverse_roughness;
  const float variance_p = fma(query->inverse_minor_variance, as_float(node_word(node, MICA_PYRAMID_NODE_SPREAD_P)), 1.0f);
  const float variance_n = fma(k * k, as_float(node_word(node, MICA_PYRAMID_NODE_SPREAD_N)), 1.0f);
  const float weight_p = 1.0f / variance_p, weight_n = k * k / ((float)MICA_BOUND_ONE * MICA_BOUND_ONE * variance_n);
  const wave_float q = fma(weight_p, fma(d1, d1, d2 * d2), weight_n * fma(d_s, d_s, d_t * d_t));
  return wave_ballot(wave_mask(q <= map->cutoff) & wave_mask(s_min <= s_max), scratch);
}

#define ELEMENT_FIELD(record, field) wave_to_float(wave_load_short((record) + MICA_RECORD_FIELDS + 16 * (field)))

// The sixteen elements of a record; without the query's scale.
static inline wave_float slice_record(global const mica_pyramid_query* query, global const short* record,
                                      group_place place, float position_unit) {
  global const int* int_header = (global const int*)record;
  global const float* header = (global const float*)record;
  const float to_roughness = query->map.inverse_roughness;
  const float offset_s = to_roughness / MICA_NORMAL_ONE * (query->map.half_s - int_header[MICA_RECORD_ORIGIN_S]);
  const float offset_t = to_roughness / MICA_NORMAL_ONE * (query->map.half_t - int_header[MICA_RECORD_ORIGIN_T]);
  const float mean_unit = -to_roughness * header[MICA_RECORD_MEAN_UNIT];
  const float p_unit = header[MICA_RECORD_POSITION_UNIT];
  const float n_unit = to_roughness * to_roughness * header[MICA_RECORD_NORMAL_UNIT];
  const float k_unit = to_roughness * header[MICA_RECORD_CROSS_UNIT];

  // m - c, and P + F with its adjugate in place of its inverse.
  const wave_float x = fma(ELEMENT_FIELD(record, MICA_ELEMENT_X), -position_unit, -place.x);
  const wave_float y = fma(ELEMENT_FIELD(record, MICA_ELEMENT_Y), -position_unit, -place.y);
  const wave_float p_xx = fma(ELEMENT_FIELD(record, MICA_ELEMENT_XX), p_unit, query->cov_xx);
  const wave_float p_xy = fma(ELEMENT_FIELD(record, MICA_ELEMENT_XY), p_unit, query->cov_xy);
  const wave_float p_yy = fma(ELEMENT_FIELD(record, MICA_ELEMENT_YY), p_unit, query->cov_yy);
  const wave_float root_p = wave_rough_rsqrt(fma(p_xx, p_yy, -(p_xy * p_xy)));
  const wave_float inverse_p = root_p * root_p;
  const wave_float a_x = fma(p_yy, x, -(p_xy * y)), a_y = fma(p_xx, y, -(p_xy * x));
  const wave_float q_position = inverse_p * fma(x, a_x, y * a_y);

  // The residual of the normal, and its covariance less what the position explains; in roughnesses.
  const wave_float k_sx = ELEMENT_FIELD(record, MICA_ELEMENT_SX), k_sy = ELEMENT_FIELD(record, MICA_ELEMENT_SY);
  const wave_float k_tx = ELEMENT_FIELD(record, MICA_ELEMENT_TX), k_ty = ELEMENT_FIELD(record, MICA_ELEMENT_TY);
  const wave_float k_p = -k_unit * inverse_p, kk_p = k_unit * k_p;
  const wave_float r_s = fma(k_p, fma(k_sx, a_x, k_sy * a_y),
                             fma(ELEMENT_FIELD(record, MICA_ELEMENT_S), mean_unit, offset_s));
  const wave_float r_t = fma(k_p, fma(k_tx, a_x, k_ty * a_y),
                             fma(ELEMENT_FIELD(record, MICA_ELEMENT_T), mean_unit, offset_t));
  const wave_float b_sx = fma(p_yy, k_sx, -(p_xy * k_sy)), b_sy = fma(p_xx, k_sy, -(p_xy * k_sx));
  const wave_float b_tx = fma(p_yy, k_tx, -(p_xy * k_ty)), b_ty = fma(p_xx, k_ty, -(p_xy * k_tx));
  const wave_float n_ss = fma(kk_p, fma(k_sx, b_sx, k_sy * b_sy),
                              fma(ELEMENT_FIELD(record, MICA_ELEMENT_SS), n_unit, 1.0f));
  const wave_float n_st = fma(kk_p, fma(k_tx, b_sx, k_ty * b_sy), n_unit * ELEMENT_FIELD(record, MICA_ELEMENT_ST));
  const wave_float n_tt = fma(kk_p, fma(k_tx, b_tx, k_ty * b_ty),
                              fma(ELEMENT_FIELD(record, MICA_ELEMENT_TT), n_unit, 1.0f));
  const wave_float root_n = wave_rough_rsqrt(fma(n_ss, n_tt, -(n_st * n_st)));
  const wave_float form = fma(r_s, fma(n_tt, r_s, -2.0f * n_st * r_t), n_ss * r_t * r_t);
  const wave_float q = fma(form * root_n, root_n, q_position);
  return ELEMENT_FIELD(record, MICA_ELEMENT_WEIGHT) * header[MICA_RECORD_WEIGHT_UNIT] * root_p * root_n *
         gaussian_exp2(max((-EXP2_SCALE * EXP2_SCALE) * q, -126.0f));
}

static inline int group_of(int i, int size, int groups, int group_size) {
  const int period = floor_divide(i, size);
  return period * groups + (i - period * size) / group_size;
}

static inline group_place place_group(global const mica_map_query* map, mica_pyramid_level level, int group_x,
                                      int group_y) {
  const int period_x = floor_divide(group_x, level.groups_x), period_y = floor_divide(group_y, level.groups_y);
  const int inside_x = group_x - period_x * level.groups_x, inside_y = group_y - period_y * level.groups_y;
  group_place place;
  place.x = (float)(period_x * level.width + inside_x * level.group_size - map->mean_i) - map->mean_x;
  place.y = (float)(period_y * level.height + inside_y * level.group_size - map->mean_j) - map->mean_y;
  place.index = inside_y * level.groups_x + inside_x;
  return place;
}

// Density of every query, in the order of their slots. Global size: queries (vectors), or 16 a query (items).
kernel void pyramid(global const mica_pyramid_query* restrict queries, int query_count, mica_pyramid_level level,
                    global const int* restrict groups, global const short* restrict top_nodes,
                    global const short* restrict nodes, global const short* restrict records,
                    global float* restrict density) {
  WAVE_DECLARE_SCRATCH(scratch);
  if (WAVE_ITEM_INDEX >= query_count) return;
  global const mica_pyramid_query* query = queries + WAVE_ITEM_INDEX;
  global const mica_map_query* map = &query->map;
  const float position_unit = (float)level.group_size / MICA_BOUND_ONE;
  // Elements lie up to their pieces' size beyond their group: that is in the level's spread.
  const float reach_x = map->extent_x, reach_y = map->extent_y;
  const int first_x = group_of(map->mean_i + (int)floor(map->mean_x - reach_x), level.width, level.groups_x, level.group_size);
  const int last_x = group_of(map->mean_i + (int)floor(map->mean_x + reach_x), level.width, level.groups_x, level.group_size);
  const int first_y = group_of(map->mean_j + (int)floor(map->mean_y - reach_y), level.height, level.groups_y, level.group_size);
  const int last_y = group_of(map->mean_j + (int)floor(map->mean_y + reach_y), level.height, level.groups_y, level.group_size);
  wave_float sum = 0.0f;
  int count = 0;
  for (int group_y = first_y; group_y <= last_y; ++group_y) {
    for (int group_x = first_x; group_x <= last_x; ++group_x) {
      const group_place place = place_group(map, level, group_x, group_y);
      for (int top = groups[place.index]; top < groups[place.index + 1]; ++top) {
        global const short* top_node = top_nodes + top * MICA_PYRAMID_NODE_STRIDE;
        uint branches = surviving_records(query, top_node, place, position_unit, scratch);
        for (; branches; branches &= branches - 1) {
          global const short* node = nodes + (node_word(top_node, MICA_PYRAMID_NODE_CHILD) + lowest_bit(branches)) * MICA_PYRAMID_NODE_STRIDE;
          uint leaves = surviving_records(query, node, place, position_unit, scratch);
          for (; leaves; leaves &= leaves - 1) {
            const size_t record = node_word(node, MICA_PYRAMID_NODE_CHILD) + lowest_bit(leaves);
            sum += slice_record(query, records + record * MICA_RECORD_STRIDE, place, position_unit);
            count += WAVE_LANES;
          }
        }
      }
    }
  }
  const float total = wave_sum(sum, scratch);
  density[map->slot] = MICA_COUNT_ELEMENTS ? (float)count : map->scale * total;
}
