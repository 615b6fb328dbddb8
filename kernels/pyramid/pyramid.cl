// `pyramid`: the P-NDF of a footprint on merged elements. A level cuts the map into blocks and the normals
// into cells, and has one 4D Gaussian in (position, normal) for each block and cell that is not empty: weight
// w, mean (c, n), covariance
//     | P    K^T |
//     | K    N   |.
// With m and F the footprint's mean and covariance, h the half vector, its share of D is exactly
//     w N(m - c; P + F) N(h - n - K A (m - c); N + sigma_r^2 I - K A K^T),   A = (P + F)^-1.
// One wave a query: boxes of sixteen children are tested at a time, and sixteen elements summed at a time.

#include "pyramid/pyramid_elements.h"
#include "wave/gaussian.h"

// 1: the sum becomes the number of elements that were evaluated, for benchmarks.
#ifndef MICA_COUNT_ELEMENTS
#define MICA_COUNT_ELEMENTS 0
#endif

typedef struct {
  wave_float sum;
  int count;
} record_results;

// The sixteen elements of a record; without the query's scale.
static inline void take_record(global const pyramid_query* query, global const short* record,
                               group_place place, private record_results* results) {
  global const mica_map_query* map = &PYRAMID(query)->map;
  const element_lobes e = slice_record(query, map->half_s, map->half_t, record, place);
  const wave_float form = fma(e.r_s, fma(e.n_tt, e.r_s, -2.0f * e.n_st * e.r_t), e.n_ss * e.r_t * e.r_t);
  const wave_float q = fma(form * e.root, e.root, e.q_position);
  results->sum += e.weight * gaussian_exp2(max((-EXP2_SCALE * EXP2_SCALE) * q, -126.0f));
  results->count += WAVE_LANES;
}

#define RECORD_TAKE(query, record, place, results, scratch) take_record(query, record, place, results)
#include "pyramid/walk_records.h"

// Density of every query, in the order of their slots. Global size: queries (vectors), or 16 a query (items).
WAVE_KERNEL void pyramid(global const pyramid_query* restrict queries, int query_count, mica_map_grid level,
                         global const int* restrict groups, global const short* restrict top_nodes,
                         global const short* restrict nodes, global const short* restrict records,
                         global float* restrict density) {
  WAVE_DECLARE_SCRATCH(scratch);
  if (WAVE_ITEM_INDEX >= query_count) return;
  global const pyramid_query* query = queries + WAVE_ITEM_INDEX;
  global const mica_map_query* map = &PYRAMID(query)->map;
  const float to_bound = (float)MICA_BOUND_ONE / MICA_NORMAL_ONE;
  const float h_s = map->half_s * to_bound, h_t = map->half_t * to_bound;
  const half_vector_box half_vector = {h_s, h_s, h_t, h_t};
  record_results results = {0.0f, 0};
  walk_records(query, half_vector, level, groups, top_nodes, nodes, records, &results, scratch);
  const float total = wave_sum(results.sum, scratch);
  density[map->slot] = MICA_COUNT_ELEMENTS ? (float)results.count : map->scale * total;
}
