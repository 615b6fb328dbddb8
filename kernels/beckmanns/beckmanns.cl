// `beckmanns`: the P-NDF of a footprint on a mixture of non-centred anisotropic Beckmann lobes. [Che18] Eq. 9
//
// An element stands for a square of the map: a lobe of the slopes under its round position kernel, and the
// weight W = N(c - m; F), c its centre, m and F the footprint's mean and what of its covariance the kernels
// leave to be added. One wave a query; leaves of 4x4 elements survive the walk and are summed sixteen at a
// time, without a branch.

#include "beckmanns/lobe_sum.h"
#include "types.h"
#include "wave/wave.h"

#define LEAF_QUERY mica_lobe_query
#define LEAF_PLACE(query) (&(query)->map)
#define LEAF_NODE_STRIDE MICA_MIXTURE_NODE_STRIDE
#define LEAF_DATA short
#define LEAF_AT(leaf_i, leaf_j) ((block.index * 16 + tile) * 16 + leaf)
#define LEAF_RESULTS lobe_sum
#define LEAF_SURVIVORS dense_lobes
#define LEAF_TAKE(query, lobes, leaf, i, j, room_i, room_j, results, scratch) \
  sum_lobes(query, lobes, leaf, i, j, room_i, room_j, results)
#include "map/walk_leaves.h"

// Density of every query, in the order of their slots. Global size: queries (vectors), or 16 a query (items).
WAVE_KERNEL void beckmanns(global const mica_lobe_query* restrict queries, int query_count,
                           mica_map_grid grid, global const short* restrict lobes,
                           global const short* restrict block_nodes, global const short* restrict tile_nodes,
                           global float* restrict density) {
  WAVE_DECLARE_SCRATCH(scratch);
  if (WAVE_ITEM_INDEX >= query_count) return;
  global const mica_lobe_query* query = queries + WAVE_ITEM_INDEX;
  lobe_sum results;
  begin_lobes(&results);
  walk_leaves(query, grid, lobes, block_nodes, tile_nodes, &results, scratch);
  density[query->map.slot] =
      (MICA_COUNT_ELEMENTS ? 1.0f : query->map.scale) * end_lobes(query, &results, scratch);
}
