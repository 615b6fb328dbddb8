// What a node of a mixture says of the elements under its sixteen children: a box of their means along an
// axis of its own, and how far they spread along it and across. host/methods/gaussians/mixture_bound.h
#ifndef MICA_ORIENTED_BOUND_H
#define MICA_ORIENTED_BOUND_H

#include "types.h"
#include "wave/wave.h"

typedef struct {
  wave_float axis_x, axis_y;                                // unit
  wave_float along_min, along_max, across_min, across_max;  // bounds of the means
  wave_float spread_along, spread_across;                   // standard deviations, at most, in units of nodes
  wave_int present;                                         // a child may lie outside of the map
} oriented_boxes;

// @param unit of the means.
static inline void load_boxes(global const short* node, float unit, private oriented_boxes* boxes) {
  boxes->axis_x = (1.0f / MICA_BOUND_ONE) * wave_to_float(wave_load_short(node));
  boxes->axis_y = (1.0f / MICA_BOUND_ONE) * wave_to_float(wave_load_short(node + 16));
  boxes->along_min = unit * wave_to_float(wave_load_short(node + 32));
  boxes->along_max = unit * wave_to_float(wave_load_short(node + 48));
  boxes->across_min = unit * wave_to_float(wave_load_short(node + 64));
  boxes->across_max = unit * wave_to_float(wave_load_short(node + 80));
  boxes->spread_along = wave_to_float(wave_load_short(node + 96));
  boxes->spread_across = wave_to_float(wave_load_short(node + 112));
  boxes->present = wave_mask(boxes->along_min <= boxes->along_max);
}

static inline wave_float outside(wave_float value, wave_float low, wave_float high) {
  return max(max(low - value, value - high), 0.0f);
}

// Makes room for means that move by (x, y) at most.
static inline void widen_boxes(private oriented_boxes* boxes, float x, float y) {
  const wave_float along = fma(fabs(boxes->axis_x), x, fabs(boxes->axis_y) * y);
  const wave_float across = fma(fabs(boxes->axis_x), y, fabs(boxes->axis_y) * x);
  boxes->along_min -= along, boxes->along_max += along;
  boxes->across_min -= across, boxes->across_max += across;
}

// Lanes whose elements may reach the cutoff at the normal or slope (x, y): q_position + d_1^2 / v_1 + d_2^2 /
// v_2 <= cutoff without the divisions, d the distance from the box in roughnesses, v the variance there in
// roughnesses squared: `rough`, and spread_variance times the square of the spread.
static inline wave_int reach_cutoff_of(const private oriented_boxes* boxes, wave_float x, wave_float y,
                                       float inverse_roughness, float spread_variance, wave_float rough,
                                       wave_float q_position, float cutoff) {
  const wave_float along = fma(boxes->axis_x, x, boxes->axis_y * y);
  const wave_float across = fma(boxes->axis_x, y, -(boxes->axis_y * x));
  const wave_float d_1 = inverse_roughness * outside(along, boxes->along_min, boxes->along_max);
  const wave_float d_2 = inverse_roughness * outside(across, boxes->across_min, boxes->across_max);
  const wave_float v_1 = fma(spread_variance * boxes->spread_along, boxes->spread_along, rough);
  const wave_float v_2 = fma(spread_variance * boxes->spread_across, boxes->spread_across, rough);
  return wave_mask(fma(d_1 * d_1, v_2, d_2 * d_2 * v_1) <= (cutoff - q_position) * v_1 * v_2) &
         boxes->present;
}

// The same of one normal or slope for all lanes.
static inline wave_int reach_cutoff(const private oriented_boxes* boxes, float x, float y,
                                    float inverse_roughness, float spread_variance, wave_float rough,
                                    wave_float q_position, float cutoff) {
  const wave_float same_x = x, same_y = y;
  return reach_cutoff_of(boxes, same_x, same_y, inverse_roughness, spread_variance, rough, q_position,
                         cutoff);
}

#endif  // MICA_ORIENTED_BOUND_H
