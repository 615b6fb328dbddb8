// The standard 2D Gaussian over right triangles with axis-parallel legs. [Yan14] Eq. 8.
//
// The longer leg is integrated by Gauss-Legendre over what the cutoff leaves of it, the shorter one in closed
// form. The hypotenuse has a slope <= 1, so the integrand is as smooth as the Gaussian, however thin the
// triangle. Half of all right triangles lie beyond the cutoff, and the others need 4 to 20 points: they are
// listed by the length of their range, short or long, and integrated when sixteen of a kind have come
// together.
#ifndef MICA_RIGHT_TRIANGLES_H
#define MICA_RIGHT_TRIANGLES_H

#include "triangles/precision.h"
#include "wave/wave_list.h"

// Lane sums with their rounding errors: a large footprint adds millions of terms.
typedef struct {
  wave_float sum, lost;
} accumulator;

static inline void accumulate(private accumulator* a, wave_float x) {
  const wave_float y = x - a->lost;
  const wave_float sum = a->sum + y;
  a->lost = (sum - a->sum) - y;
  a->sum = sum;
}

#define RIGHT_FIELDS 7
#define RIGHT_RECORDS (RIGHT_FIELDS * WAVE_LIST)
typedef struct {
  accumulator total;
  wave_list short_ones, long_ones;  // right triangles, by their range
} integrator;

// y = y_middle + y_slope * node in the scale of triangle_exp2, the hypotenuse in that of
// triangle_cdf. Lanes beyond the cutoff have a y_slope of zero.
typedef struct {
  wave_float y_middle, y_slope, q_plane, limit_middle, limit_slope, fixed, weight;
} right_triangles;

// Integrates the first sixteen of a list, or as many as there are.
static inline void integrate_first(private wave_list* list, private accumulator* total,
                                   WAVE_SHARED int* scratch) {
  const wave_float zero = 0.0f;
  const wave_int valid = wave_mask(WAVE_LANE < list->count);
  const wave_float y_middle = wave_list_field(*list, 0);
  const wave_float y_slope = wave_select(zero, wave_list_field(*list, 1), valid);
  const wave_float q_plane = wave_list_field(*list, 2);
  const wave_float limit_middle = wave_list_field(*list, 3), limit_slope = wave_list_field(*list, 4);
  const wave_float fixed = wave_list_field(*list, 5), weight = wave_list_field(*list, 6);
  wave_list_drop(list, RIGHT_FIELDS);
  int points;
  const int first = legendre_rule(2.0f / EXP2_SCALE * wave_max(y_slope, scratch), &points);
  wave_float sum = 0.0f;
  for (int k = first; k < first + points; ++k) {
    const wave_float y = fma(y_slope, legendre_nodes[k], y_middle);
    const wave_float gaussian = triangle_exp2(fma(-y, y, q_plane));
    const wave_float inside = triangle_cdf(fma(limit_slope, legendre_nodes[k], limit_middle)) - fixed;
    sum = fma(legendre_weights[k] * inside, gaussian, sum);
  }
  accumulate(total, wave_select(zero, COUNTED(POINT_FLOPS * points, fabs(sum) * weight), valid));
}

static inline void append_right_triangles(right_triangles triangles, uint bits, private wave_list* list,
                                          private accumulator* total, WAVE_SHARED int* scratch) {
  wave_list_pack(*list, 0, bits, triangles.y_middle);
  wave_list_pack(*list, 1, bits, triangles.y_slope);
  wave_list_pack(*list, 2, bits, triangles.q_plane);
  wave_list_pack(*list, 3, bits, triangles.limit_middle);
  wave_list_pack(*list, 4, bits, triangles.limit_slope);
  wave_list_pack(*list, 5, bits, triangles.fixed);
  wave_list_pack(*list, 6, bits, triangles.weight);
  wave_list_count(list, bits);
  if (list->count >= WAVE_LANES) integrate_first(list, total, scratch);
}

// Triangles with legs from (t, x) to (t + t_leg, x) and to (t, x + x_leg), whose integrals exp(-q_plane / 2)
// * weight multiplies.
static inline right_triangles make_right_triangles(wave_float t, wave_float t_leg, wave_float x,
                                                   wave_float x_leg, wave_float q_plane, wave_float weight,
                                                   float cutoff) {
  const wave_int swap = wave_mask(fabs(t_leg) < fabs(x_leg));
  const wave_float outer = wave_select(t, x, swap), outer_leg = wave_select(t_leg, x_leg, swap);
  const wave_float inner = wave_select(x, t, swap), inner_leg = wave_select(x_leg, t_leg, swap);
  // Where the inner interval lies off the axis, less of the outer one is within the cutoff.
  const wave_float inner_end = inner + inner_leg;
  const wave_float off = max(max(min(inner, inner_end), -max(inner, inner_end)), 0.0f);
  const wave_float below = cutoff - q_plane - off * off, beyond = 1e-20f;
  const wave_float reach_squared = wave_select(beyond, below + BEYOND_CUTOFF, wave_mask(below > beyond));
  const wave_float reach = reach_squared * wave_rsqrt(reach_squared);
  const wave_float y0 = min(max(outer, -reach), reach), y1 = min(max(outer + outer_leg, -reach), reach);
  const wave_float middle = 0.5f * (y0 + y1), half_range = 0.5f * fabs(y1 - y0);
  const wave_float inverse_leg = wave_rsqrt(max(outer_leg * outer_leg, 1e-30f));
  const wave_float slope = -inner_leg * copysign(inverse_leg, outer_leg);

  right_triangles result;
  result.y_middle = EXP2_SCALE * middle, result.y_slope = EXP2_SCALE * half_range;
  result.q_plane = MINUS_HALF_LOG2_E * q_plane;
  result.limit_middle = TRIANGLE_CDF_SCALE * fma(slope, middle - outer, inner_end);
  result.limit_slope = TRIANGLE_CDF_SCALE * slope * half_range;
  result.fixed = triangle_cdf(TRIANGLE_CDF_SCALE * inner);
  result.weight = weight * half_range;
  return result;
}

static inline void list_right_triangles(right_triangles triangles, private integrator* out,
                                        WAVE_SHARED int* scratch) {
  const float least = 1e-8f, short_most = 0.5f * SHORT_RANGE * EXP2_SCALE;
  const uint some = wave_ballot(wave_mask(triangles.y_slope > least), scratch);
  const uint is_long = wave_ballot(wave_mask(triangles.y_slope > short_most), scratch),
             is_short = some & ~is_long;
  if (is_short) append_right_triangles(triangles, is_short, &out->short_ones, &out->total, scratch);
  if (is_long) append_right_triangles(triangles, is_long, &out->long_ones, &out->total, scratch);
}

static inline void integrate_rest(private integrator* out, WAVE_SHARED int* scratch) {
  if (out->short_ones.count) integrate_first(&out->short_ones, &out->total, scratch);
  if (out->long_ones.count) integrate_first(&out->long_ones, &out->total, scratch);
}

#endif  // MICA_RIGHT_TRIANGLES_H
