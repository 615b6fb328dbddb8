// The densities of the Beckmann lobes that matter to a half vector, summed leaf by leaf.
#ifndef MICA_LOBE_SUM_H
#define MICA_LOBE_SUM_H

#include "beckmanns/lobe.h"
#include "beckmanns/lobe_bound.h"
#include "types.h"
#include "wave/wave.h"

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

typedef struct {
  int leaves;
  lobe_wave met;
  slice_wave sliced;
  wave_float weight;  // weight of what is sliced
  wave_float sum;
} lobe_sum;

static inline void begin_lobes(private lobe_sum* results) {
  const wave_float zero = 0.0f, one = 1.0f, nowhere = NOWHERE;
  results->leaves = 0;
  results->met.p_x = results->met.p_y = results->met.d_x = results->met.d_y = zero;
  results->met.inverse_root_w = one;
  results->met.spread_xx = results->met.spread_yx = results->met.spread_yy = zero;
  results->met.q_position = results->sliced.q_position = nowhere;
  results->sliced.form = zero, results->sliced.det = one;
  results->weight = results->sum = zero;
}

// The three steps, each of another leaf.
static inline void advance_lobes(global const mica_lobe_query* query, private lobe_sum* results,
                                 private const lobe_wave* next) {
  results->sum = fma(results->weight, slice_density(&results->sliced), results->sum);
  slice_lobes(query, &results->met, &results->sliced, &results->weight);
  results->met = *next;
}

// Adds leaves that are still under way. Sum over all lanes, without the query's scale; or how many elements
// there were.
static inline float end_lobes(global const mica_lobe_query* query, private lobe_sum* results,
                              WAVE_SHARED int* scratch) {
  const lobe_wave last = results->met;
  for (int step = 0; step < 2; ++step) advance_lobes(query, results, &last);
  const float sum = wave_sum(results->sum, scratch);
  if (MICA_COUNT_ELEMENTS) return (float)(WAVE_LANES * results->leaves);
  return results->leaves > 0 ? sum : 0.0f;
}

// Adds a leaf; `lobes` has its spreads in roughnesses.
static inline void add_lobes(global const mica_lobe_query* query, const private lobe_leaf* lobes,
                             wave_float q_position, private lobe_sum* results) {
  lobe_wave next;
  meet_lobes(query, lobes, q_position, &next);
  advance_lobes(query, results, &next);
  ++results->leaves;
}

// Adds leaf number `leaf`, whose first element lies (i, j) elements from the mean.
static inline void sum_lobes(global const mica_lobe_query* query, global const short* leaves, int leaf, int i,
                             int j, int room_i, int room_j, private lobe_sum* results) {
  lobe_leaf lobes;
  load_lobes(leaves + leaf * MICA_LOBE_LEAF, query->map.inverse_roughness, &lobes);
  add_lobes(query, &lobes, lobe_positions(&query->map, i, j, room_i, room_j), results);
}

#endif  // MICA_LOBE_SUM_H
