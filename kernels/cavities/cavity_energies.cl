// What leaves a footprint's V-shaped cavities after one bounce: E_1 of every seed under it, averaged by their
// weights. [Che19] Eqs. 8 and 15. A seed's E_1 is that of facets spread about its normal by the roughness.
// One wave a query.

#include "cavities/cavity.h"
#include "cavities/cavity_seeds.h"
#include "map/map_cull.h"
#include "wave/gaussian.h"

// Bits of the children that the footprint reaches; their normals do not matter.
static inline uint seen_children(global const mica_cavity_query* query, global const short* node, int i,
                                 int j, int child_size, WAVE_SHARED int* scratch) {
  const wave_float x = wave_to_float(i + (WAVE_LANE & 3) * child_size) - query->map.mean_x;
  const wave_float y = wave_to_float(j + (WAVE_LANE >> 2) * child_size) - query->map.mean_y;
  const wave_int seen = wave_mask(footprint_bound(&query->map, x, y, (float)child_size) <= query->map.cutoff);
  return wave_ballot(seen & wave_mask(wave_load_short(node) <= wave_load_short(node + 16)), scratch);
}

typedef struct {
  wave_float weights, energies;
} leaf_results;

static inline void take_energies(global const mica_cavity_query* query, global const int* normals, int at,
                                 int i, int j, int room_i, int room_j, private leaf_results* sums) {
  const wave_int column = WAVE_LANE & 3, row = WAVE_LANE >> 2;
  const wave_int inside_map = wave_mask(column < room_i) & wave_mask(row < room_j);
  const wave_float x = wave_to_float(i + column) + SEED_FIRST, y = wave_to_float(j + row) + SEED_FIRST;
  const wave_float nothing = 0.0f;
  for (int b = 0; b < MICA_SEEDS; ++b) {
    for (int a = 0; a < MICA_SEEDS; ++a) {
      const wave_float s = wave_to_float(seed_normals(normals + at, a, b)) * (1.0f / MICA_NORMAL_ONE);
      const wave_float t =
          wave_to_float(seed_normals(normals + at + MICA_BLOCK_PLANE, a, b)) * (1.0f / MICA_NORMAL_ONE);
      const wave_float energy =
          cavity_blurred_energy(s, t, query->roughness, query->view_x, query->view_y, query->view_z, 0, 1);
      const wave_float q = seed_distances(&query->map, x + a * SEED_SPACING, y + b * SEED_SPACING);
      const wave_float weight =
          wave_select(nothing, gaussian_exp2(max((-EXP2_SCALE * EXP2_SCALE) * q, -126.0f)), inside_map);
      sums->weights += weight;
      sums->energies = fma(weight, energy, sums->energies);
    }
  }
}

#define LEAF_QUERY mica_cavity_query
#define LEAF_PLACE(query) (&(query)->map)
#define LEAF_NODE_STRIDE MICA_NODE_STRIDE
#define LEAF_SURVIVORS seen_children
#define LEAF_TAKE(query, normals, at, i, j, room_i, room_j, sums, scratch) \
  take_energies(query, normals, at, i, j, room_i, room_j, sums)
#include "map/walk_leaves.h"

// E_1 of every query, in the order of their slots. Global size: queries (vectors), or 16 a query (items).
WAVE_KERNEL void cavity_energies(global const mica_cavity_query* restrict queries, int query_count,
                                 mica_map_grid grid, global const int* restrict normals,
                                 global const short* restrict block_nodes,
                                 global const short* restrict tile_nodes, global float* restrict energy) {
  WAVE_DECLARE_SCRATCH(scratch);
  if (WAVE_ITEM_INDEX >= query_count) return;
  global const mica_cavity_query* query = queries + WAVE_ITEM_INDEX;
  leaf_results sums = {0.0f, 0.0f};
  walk_leaves(query, grid, normals, block_nodes, tile_nodes, &sums, scratch);
  const float weights = wave_sum(sums.weights, scratch), energies = wave_sum(sums.energies, scratch);
  energy[query->map.slot] = weights > 0.0f ? energies / weights : 0.0f;
}
