// `cavities`: light that bounces once inside the V-shaped cavities under a footprint. [Che19] Eqs. 7 and 17
//
// A seed of the map at c, with normal n on the disk, has the weight W = N(c - m; F + k I): m and F are the
// footprint's mean and covariance, k the variance of the seeds' position kernel. Its facets spread by the
// roughness about n, their duals about -n, so a light that mirrors the view in the half vector h meets
//     sum W (N(h - n; sigma_r^2) + N(h + n; sigma_r^2))
// of them: the hierarchy is asked at +h and -h. How much of that is seen and lit depends on h alone and is
// part of the query's scale. One wave a query.

#include "cavities/cavity_seeds.h"
#include "map/map_cull.h"
#include "wave/gaussian.h"

// 1: the sum becomes the number of seeds that were evaluated, for benchmarks.
#ifndef MICA_COUNT_ELEMENTS
#define MICA_COUNT_ELEMENTS 0
#endif

// Bits of the children of `node` that reach the cutoff at the half vector or at its opposite; as in
// map_cull.h.
static inline uint surviving_cavities(global const mica_map_query* query, global const short* node, int i,
                                      int j, int child_size, WAVE_SHARED int* scratch) {
  const wave_float s_min = wave_to_float(wave_load_short(node));
  const wave_float s_max = wave_to_float(wave_load_short(node + 16));
  const wave_float t_min = wave_to_float(wave_load_short(node + 32));
  const wave_float t_max = wave_to_float(wave_load_short(node + 48));
  const float to_bound = (float)MICA_BOUND_ONE / MICA_NORMAL_ONE;
  const float h_s = query->half_s * to_bound, h_t = query->half_t * to_bound;
  const wave_float d_s = max(max(s_min - h_s, h_s - s_max), 0.0f),
                   d_t = max(max(t_min - h_t, h_t - t_max), 0.0f);
  const wave_float e_s = max(max(s_min + h_s, -h_s - s_max), 0.0f),
                   e_t = max(max(t_min + h_t, -h_t - t_max), 0.0f);
  const float k = query->inverse_roughness / MICA_BOUND_ONE;
  const wave_float q_normal = k * k * min(fma(d_s, d_s, d_t * d_t), fma(e_s, e_s, e_t * e_t));
  const wave_float x = wave_to_float(i + (WAVE_LANE & 3) * child_size) - query->mean_x;
  const wave_float y = wave_to_float(j + (WAVE_LANE >> 2) * child_size) - query->mean_y;
  const wave_float q = q_normal + footprint_bound(query, x, y, (float)child_size);
  return wave_ballot(wave_mask(q <= query->cutoff) & wave_mask(s_min <= s_max), scratch);
}

typedef wave_float leaf_results;

// The seeds of a leaf whose lower left texel is stored at `at` and lies (i, j) texels from the mean.
static inline void take_cavities(global const mica_map_query* query, global const int* normals, int at, int i,
                                 int j, int room_i, int room_j, private wave_float* sum) {
  const wave_int column = WAVE_LANE & 3, row = WAVE_LANE >> 2;
  const wave_int inside_map = wave_mask(column < room_i) & wave_mask(row < room_j);
  const wave_float x = wave_to_float(i + column) + SEED_FIRST, y = wave_to_float(j + row) + SEED_FIRST;
  const float to_exponent = EXP2_SCALE * query->inverse_roughness / MICA_NORMAL_ONE;
  wave_float leaf_sum = 0.0f;
  for (int b = 0; b < MICA_SEEDS; ++b) {
    for (int a = 0; a < MICA_SEEDS; ++a) {
      const wave_int n_s = seed_normals(normals + at, a, b),
                     n_t = seed_normals(normals + at + MICA_BLOCK_PLANE, a, b);
      // Exact differences of fixed-point numbers: rounding begins here.
      const wave_float d_s = to_exponent * wave_to_float(query->half_s - n_s),
                       d_t = to_exponent * wave_to_float(query->half_t - n_t);
      const wave_float e_s = to_exponent * wave_to_float(query->half_s + n_s),
                       e_t = to_exponent * wave_to_float(query->half_t + n_t);
      const wave_float q = seed_distances(query, x + a * SEED_SPACING, y + b * SEED_SPACING);
      const wave_float position = (-EXP2_SCALE * EXP2_SCALE) * q;
      leaf_sum += gaussian_exp2(max(fma(-d_s, d_s, fma(-d_t, d_t, position)), -126.0f)) +
                  gaussian_exp2(max(fma(-e_s, e_s, fma(-e_t, e_t, position)), -126.0f));
    }
  }
  const wave_float nothing = 0.0f, count = MICA_SEEDS * MICA_SEEDS;
  *sum += wave_select(nothing, MICA_COUNT_ELEMENTS ? count : leaf_sum, inside_map);
}

#define LEAF_QUERY mica_map_query
#define LEAF_NODE_STRIDE MICA_NODE_STRIDE
#define LEAF_SURVIVORS surviving_cavities
#define LEAF_TAKE(query, normals, at, i, j, room_i, room_j, sum, scratch) \
  take_cavities(query, normals, at, i, j, room_i, room_j, sum)
#include "map/walk_leaves.h"

// f_1(o, i) max(i.g, 0) of every query, in the order of their slots. Global size: queries (vectors), or 16 a
// query (items).
WAVE_KERNEL void cavities(global const mica_map_query* restrict queries, int query_count, mica_map_grid grid,
                          global const int* restrict normals, global const short* restrict block_nodes,
                          global const short* restrict tile_nodes, global float* restrict density) {
  WAVE_DECLARE_SCRATCH(scratch);
  if (WAVE_ITEM_INDEX >= query_count) return;
  global const mica_map_query* query = queries + WAVE_ITEM_INDEX;
  wave_float sum = 0.0f;
  walk_leaves(query, grid, normals, block_nodes, tile_nodes, &sum, scratch);
  const float total = wave_sum(sum, scratch);
  density[query->slot] = MICA_COUNT_ELEMENTS ? total : query->scale * total;
}
