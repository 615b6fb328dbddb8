// `beckmanns`: the P-NDF of a footprint on a mixture of non-centred anisotropic Beckmann lobes. [Che18] Eq. 9
//
// An element stands for a square of the map: a lobe of the slopes under its round position kernel, and the weight
// W = N(c - m; F), c its centre, m and F the footprint's mean and what of its covariance the kernels leave to be added.
// One wave a query; leaves of 4x4 elements survive the walk and are summed sixteen at a time, without a branch.

#include "lobe.h"
#include "lobe_bound.h"
#include "types.h"
#include "wave.h"

// 1: the sum becomes the number of elements that were evaluated, for benchmarks.
#ifndef MICA_COUNT_ELEMENTS
#define MICA_COUNT_ELEMENTS 0
#endif

static inline uint surviving_lobes(global const mica_lobe_query* query, global const short* node, int i, int j,
                                   int child_size, WAVE_SHARED int* scratch) {
  const lobe_children children = load_children(query, node, i, j, child_size);
  return wave_ballot(matter_to_density(query, &children), scratch);
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
