// The densities of the Beckmann lobes that matter to a half vector, summed leaf by leaf.
#ifndef MICA_LOBE_SUM_H
#define MICA_LOBE_SUM_H

#include "lobe.h"
#include "lobe_bound.h"
#include "types.h"
#include "wave.h"

// 1: the sum becomes the number of elements that were evaluated, for benchmarks.
#ifndef MICA_COUNT_ELEMENTS
#define MICA_COUNT_ELEMENTS 0
#endif

// Bits of the children of `node` that matter.
static inline uint dense_lobes(global const mica_lobe_query* query, global const short* node, int i, int j,
                               int child_size, WAVE_SHARED int* scratch) {
  lobe_children children;
  load_children(query, node, i, j, child_size, &children);
  return wave_ballot(matter_to_density(query, &children), scratch);
}

// Adds leaf number `leaf`, whose first element lies (i, j) elements from the mean.
static inline void sum_lobes(global const mica_lobe_query* query, global const short* leaves, int leaf, int i, int j,
                             int room_i, int room_j, private wave_float* sum) {
  lobe_leaf lobes;
  load_lobes(leaves + leaf * MICA_LOBE_LEAF, query->map.inverse_roughness, &lobes);
  const wave_float densities = lobe_densities(query, &lobes, lobe_positions(&query->map, i, j));
  const wave_int inside_map = wave_mask((WAVE_LANE & 3) < room_i) & wave_mask((WAVE_LANE >> 2) < room_j);
  const wave_float nothing = 0.0f, one = 1.0f;
  *sum += wave_select(nothing, MICA_COUNT_ELEMENTS ? one : densities, inside_map);
}

#endif  // MICA_LOBE_SUM_H
