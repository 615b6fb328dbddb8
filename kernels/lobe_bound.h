// What a node says of the lobes under its sixteen children, and which of them can matter to a density.
#ifndef MICA_LOBE_BOUND_H
#define MICA_LOBE_BOUND_H

#include "map_cull.h"
#include "types.h"
#include "wave.h"

typedef struct {
  wave_float x_min, x_max, y_min, y_max;  // slopes
  wave_float w;                           // 1 + |p|^2, at most
  wave_float spread;                      // standard deviation on the disk, at most, in units of nodes
  wave_float q_position;                  // whitened squared distance of their centres, at least
  wave_int present;                       // a child may lie outside of the map
} lobe_children;

// The node's lower left corner is (i, j) elements from the footprint's whole mean; centres lie half an element inside.
static inline lobe_children load_children(global const mica_lobe_query* query, global const short* node, int i, int j,
                                          int child_size) {
  global const mica_map_query* place = &query->map;
  const float unit = query->slope_unit;
  lobe_children children;
  children.x_min = unit * wave_to_float(wave_load_short(node));
  children.x_max = unit * wave_to_float(wave_load_short(node + 16));
  children.y_min = unit * wave_to_float(wave_load_short(node + 32));
  children.y_max = unit * wave_to_float(wave_load_short(node + 48));
  children.spread = wave_to_float(wave_load_short(node + 64));
  const wave_float far_x = max(fabs(children.x_min), fabs(children.x_max));
  const wave_float far_y = max(fabs(children.y_min), fabs(children.y_max));
  children.w = fma(far_x, far_x, fma(far_y, far_y, 1.0f));
  const wave_float x = wave_to_float(i + (WAVE_LANE & 3) * child_size) - (place->mean_x - 0.5f);
  const wave_float y = wave_to_float(j + (WAVE_LANE >> 2) * child_size) - (place->mean_y - 0.5f);
  children.q_position = footprint_bound(place, x, y, child_size - 1.0f);
  children.present = wave_mask(children.x_min <= children.x_max);
  return children;
}

// Lanes of the children that reach the cutoff, as in map_cull.h.
static inline wave_int matter_to_density(global const mica_lobe_query* query, const private lobe_children* c) {
  const wave_float d_x = max(max(c->x_min - query->slope_x, query->slope_x - c->x_max), 0.0f);
  const wave_float d_y = max(max(c->y_min - query->slope_y, query->slope_y - c->y_max), 0.0f);
  const float k = query->map.inverse_roughness;
  const wave_float variance = fma(query->spread_variance * c->spread, c->spread, 1.0f);
  // q_normal + q_position <= cutoff without a division, and |B^-1 d|^2 >= |d|^2 / w^3.
  return wave_mask(k * k * fma(d_x, d_x, d_y * d_y) <=
                   (query->map.cutoff - c->q_position) * variance * c->w * c->w * c->w) &
         c->present;
}

#endif  // MICA_LOBE_BOUND_H
