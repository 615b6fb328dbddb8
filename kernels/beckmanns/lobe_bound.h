// What a node says of the lobes under its sixteen children, and which of them can matter to a density.
#ifndef MICA_LOBE_BOUND_H
#define MICA_LOBE_BOUND_H

#include "map/map_cull.h"
#include "map/oriented_bound.h"
#include "types.h"
#include "wave/wave.h"

typedef struct {
  oriented_boxes boxes;   // boxes around the lobes' slopes
  wave_float w;           // 1 + |p|^2, at most
  wave_float q_position;  // whitened squared distance of their centres, at least
} lobe_children;

// The node's lower left corner is (i, j) elements from the footprint's whole mean; centres lie half an
// element inside.
static inline void load_children(global const mica_lobe_query* query, global const short* node, int i, int j,
                                 int child_size, private lobe_children* children) {
  global const mica_map_query* place = &query->map;
  load_boxes(node, query->slope_unit, &children->boxes);
  const wave_float far_1 = max(fabs(children->boxes.along_min), fabs(children->boxes.along_max));
  const wave_float far_2 = max(fabs(children->boxes.across_min), fabs(children->boxes.across_max));
  children->w = fma(far_1, far_1, fma(far_2, far_2, 1.0f));
  const wave_float x = wave_to_float(i + (WAVE_LANE & 3) * child_size) - (place->mean_x - 0.5f);
  const wave_float y = wave_to_float(j + (WAVE_LANE >> 2) * child_size) - (place->mean_y - 0.5f);
  children->q_position = footprint_bound(place, x, y, child_size - 1.0f);
}

// Lanes of the children that reach the cutoff. A lobe's covariance is C + sigma_r^2 B^2, and |B d|^2 <= w^3
// |d|^2.
static inline wave_int matter_to_density(global const mica_lobe_query* query,
                                         const private lobe_children* c) {
  return reach_cutoff(&c->boxes, query->slope_x, query->slope_y, query->map.inverse_roughness,
                      query->spread_variance, c->w * c->w * c->w, c->q_position, query->map.cutoff);
}

#endif  // MICA_LOBE_BOUND_H
