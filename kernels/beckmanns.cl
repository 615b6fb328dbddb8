// `beckmanns`: the P-NDF of a footprint on a mixture of non-centred anisotropic Beckmann lobes. [Che18] Eq. 9
//
// An element stands for a square of the map: a lobe of the slopes under its round position kernel, and the weight
// W = N(c - m; F), c its centre, m and F the footprint's mean and what of its covariance the kernels leave to be added.
// One wave a query; leaves of 4x4 elements survive the walk and are summed sixteen at a time, without a branch.

#include "lobe.h"
#include "map_cull.h"
#include "types.h"
#include "wave.h"

// 1: the sum becomes the number of elements that were evaluated, for benchmarks.
#ifndef MICA_COUNT_ELEMENTS
#define MICA_COUNT_ELEMENTS 0
#endif

// Bits of the children of `node` that reach the cutoff; as in map_cull.h, for means in a box of slopes and standard
// deviations of up to `spread` on the disk about them, at centres that lie half an element inside the children.
static inline uint surviving_lobes(global const mica_lobe_query* query, global const short* node, int i, int j,
                                   int child_size, WAVE_SHARED int* scratch) {
  global const mica_map_query* place = &query->map;
  const float unit = query->slope_unit;
  const wave_float x_min = unit * wave_to_float(wave_load_short(node));
  const wave_float x_max = unit * wave_to_float(wave_load_short(node + 16));
  const wave_float y_min = unit * wave_to_float(wave_load_short(node + 32));
  const wave_float y_max = unit * wave_to_float(wave_load_short(node + 48));
  const wave_float spread = wave_to_float(wave_load_short(node + 64));
  const wave_float d_x = max(max(x_min - query->slope_x, query->slope_x - x_max), 0.0f);
  const wave_float d_y = max(max(y_min - query->slope_y, query->slope_y - y_max), 0.0f);
  // |B^-1 d|^2 >= |d|^2 / w^3
  const wave_float far_x = max(fabs(x_min), fabs(x_max)), far_y = max(fabs(y_min), fabs(y_max));
  const wave_float w = fma(far_x, far_x, fma(far_y, far_y, 1.0f));
  const wave_float variance = fma(query->spread_variance * spread, spread, 1.0f);
  const wave_float x = wave_to_float(i + (WAVE_LANE & 3) * child_size) - (place->mean_x - 0.5f);
  const wave_float y = wave_to_float(j + (WAVE_LANE >> 2) * child_size) - (place->mean_y - 0.5f);
  const wave_float q_position = footprint_bound(place, x, y, child_size - 1.0f);
  const float k = place->inverse_roughness;
  const wave_int survives =
      wave_mask(k * k * fma(d_x, d_x, d_y * d_y) <= (place->cutoff - q_position) * variance * w * w * w);
  return wave_ballot(survives & wave_mask(x_min <= x_max), scratch);
}

typedef wave_float leaf_results;

static inline void take_lobes(global const mica_lobe_query* query, global const short* leaves, int leaf, int i, int j,
                              int room_i, int room_j, private wave_float* sum) {
  const lobe_leaf lobes = load_lobes(leaves + leaf * MICA_LOBE_LEAF, query->map.inverse_roughness);
  const wave_float densities = lobe_densities(query, &lobes, lobe_positions(&query->map, i, j));
  const wave_int inside_map = wave_mask((WAVE_LANE & 3) < room_i) & wave_mask((WAVE_LANE >> 2) < room_j);
  const wave_float nothing = 0.0f, one = 1.0f;
  *sum += wave_select(nothing, MICA_COUNT_ELEMENTS ? one : densities, inside_map);
}

#define LEAF_QUERY mica_lobe_query
#define LEAF_PLACE(query) (&(query)->map)
#define LEAF_NODE_STRIDE MICA_MIXTURE_NODE_STRIDE
#define LEAF_DATA short
#define LEAF_AT(leaf_i, leaf_j) ((block.index * 16 + tile) * 16 + leaf)
#define LEAF_SURVIVORS surviving_lobes
#define LEAF_TAKE(query, lobes, leaf, i, j, room_i, room_j, sum, scratch) \
  take_lobes(query, lobes, leaf, i, j, room_i, room_j, sum)
#include "walk_leaves.h"

// Density of every query, in the order of their slots. Global size: queries (vectors), or 16 a query (items).
kernel void beckmanns(global const mica_lobe_query* restrict queries, int query_count, mica_map_grid grid,
                      global const short* restrict lobes, global const short* restrict block_nodes,
                      global const short* restrict tile_nodes, global float* restrict density) {
  WAVE_DECLARE_SCRATCH(scratch);
  if (WAVE_ITEM_INDEX >= query_count) return;
  global const mica_lobe_query* query = queries + WAVE_ITEM_INDEX;
  wave_float sum = 0.0f;
  walk_leaves(query, grid, lobes, block_nodes, tile_nodes, &sum, scratch);
  const float total = wave_sum(sum, scratch);
  density[query->map.slot] = MICA_COUNT_ELEMENTS ? total : query->map.scale * total;
}
