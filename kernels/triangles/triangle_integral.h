// The integral of a Gaussian over a triangle, sixteen at a time. [Yan14] Eq. 8, to single precision in all
// regimes.
//
// On a triangle the normal is affine, so Q(u) = |W (u - mean)|^2 + |n(u) - h|^2 / sigma_r^2 is a quadratic
// and the integrand exp(-Q/2) a 2D Gaussian. With R the 4-vector whose squared length is Q, R(u) = R0 + M (u
// - corner).
//   - Triangles that are small beside the Gaussian: Gauss points of degree 2, 4 or 6.
//   - Quads that are thin beside it, one way: strips.h.
//   - All others: M is brought to triangular form (Gram-Schmidt), which whitens the Gaussian without squaring
//   its
//     condition number. The altitude on the longest edge cuts the whitened triangle into two right triangles
//     whose legs are the axes; see right_triangles.h.
#ifndef MICA_TRIANGLE_INTEGRAL_H
#define MICA_TRIANGLE_INTEGRAL_H

#include "triangles/right_triangles.h"
#include "triangles/strips.h"
#include "wave/wave.h"

// Squared length of the longest whitened edge.
static inline wave_float longest_edge_squared(affine_residual r) {
  const wave_float a11 = dot4(r.m1, r.m1), a22 = dot4(r.m2, r.m2);
  return max(max(a11, a22), fma(-2.0f, dot4(r.m1, r.m2), a11 + a22));
}

// Integral of exp(-Q/2) over the unit right triangle by `count` Gauss points from row `first`.
static inline wave_float integrate_by_points(affine_residual r, int first, int count) {
  const wave_float q0 = MINUS_HALF_LOG2_E * dot4(r.r0, r.r0);
  const wave_float b1 = 2.0f * MINUS_HALF_LOG2_E * dot4(r.r0, r.m1),
                   b2 = 2.0f * MINUS_HALF_LOG2_E * dot4(r.r0, r.m2);
  const wave_float a11 = MINUS_HALF_LOG2_E * dot4(r.m1, r.m1), a22 = MINUS_HALF_LOG2_E * dot4(r.m2, r.m2);
  const wave_float a12 = 2.0f * MINUS_HALF_LOG2_E * dot4(r.m1, r.m2);
  wave_float sum = 0.0f;
  for (int k = first; k < first + count; ++k) {
    const float x = triangle_points[3 * k], y = triangle_points[3 * k + 1];
    const wave_float linear_x = fma(a11, x, fma(a12, y, b1)), linear_y = fma(a22, y, b2);
    const wave_float q = fma(linear_x, x, fma(linear_y, y, q0));
    sum = fma(triangle_exp2(min(max(q, -126.0f), 0.0f)), triangle_points[3 * k + 2], sum);
  }
  return COUNTED(48 + 25 * count, sum);
}

// A triangle in whitened coordinates, turned so that t runs along its longest edge and x along the altitude
// on it.
typedef struct {
  wave_float t_start, t_apex, t_end;
  wave_float x_base, altitude;
  wave_float q_plane;  // the part of Q that no point of the plane can undo
  wave_float
      weight;  // sqrt(2 pi) / sqrt(det M^T M): what the standard Gaussian's integral is multiplied with
} whitened_triangle;

static inline whitened_triangle whiten(affine_residual r) {
  // M = (q1 q2) (r11 r12; 0 r22), and (x0, y0) the corner in the coordinates of q1, q2.
  const wave_float a11 = dot4(r.m1, r.m1), a12 = dot4(r.m1, r.m2);
  const wave_float inverse_r11 = wave_rsqrt(a11);
  const residual m2 = subtract(r.m2, a12 * inverse_r11 * inverse_r11, r.m1);
  const wave_float a22 = dot4(m2, m2);
  const wave_float inverse_r22 = wave_rsqrt(a22);
  const wave_float x0 = dot4(r.r0, r.m1) * inverse_r11;
  const residual without_q1 = subtract(r.r0, x0 * inverse_r11, r.m1);
  const wave_float y0 = dot4(without_q1, m2) * inverse_r22;
  const residual rest = subtract(without_q1, y0 * inverse_r22, m2);

  // Edges (r11, 0), (r12, r22) and their difference; the longest becomes the base, from `base` along `d`.
  const wave_float r11 = a11 * inverse_r11, r12 = a12 * inverse_r11, r22 = a22 * inverse_r22;
  const wave_float d3_x = r12 - r11;
  const wave_float length2_2 = fma(r12, r12, a22), length2_3 = fma(d3_x, d3_x, a22);
  const wave_int second = wave_mask(length2_2 > a11);
  const wave_float length2_12 = max(a11, length2_2);
  const wave_int third = wave_mask(length2_3 > length2_12);
  const wave_float length2 = max(length2_12, length2_3);
  const wave_float zero = 0.0f;
  const wave_float base_x = wave_select(x0, x0 + r11, third);
  const wave_float d_x = wave_select(wave_select(r11, r12, second), d3_x, third);
  const wave_float d_y = wave_select(wave_select(zero, r22, second), r22, third);
  const wave_float apex_x = wave_select(wave_select(x0 + r12, x0 + r11, second), x0, third);
  const wave_float apex_y = wave_select(wave_select(y0 + r22, y0, second), y0, third);

  const wave_float inverse_length = wave_rsqrt(length2);
  const wave_float t_x = d_x * inverse_length, t_y = d_y * inverse_length;
  whitened_triangle result;
  result.t_start = fma(base_x, t_x, y0 * t_y);
  result.t_apex = fma(apex_x, t_x, apex_y * t_y);
  result.t_end = fma(length2, inverse_length, result.t_start);
  result.x_base = fma(y0, t_x, -base_x * t_y);
  result.altitude = fma(apex_y, t_x, -apex_x * t_y) - result.x_base;
  result.q_plane = dot4(rest, rest);
  result.weight = 2.5066283f * inverse_r11 * inverse_r22;
  return result;
}

// Integrals of exp(-Q/2) over pairs of unit right triangles, in lanes where `valid` is set; the largest
// triangle of the wave chooses the method. Pairs, because two independent chains of arithmetic take hardly
// longer than one.
static inline void integrate_triangle_pairs(affine_residual a, affine_residual b, wave_int valid,
                                            float cutoff, private integrator* out, WAVE_SHARED int* scratch) {
  const wave_float zero = 0.0f;
  const wave_float longest = max(longest_edge_squared(a), longest_edge_squared(b));
  const float longest2 = wave_max(wave_select(zero, longest, valid), scratch);
  if (longest2 <= TWELVE_POINTS) {
    const int first = longest2 <= THREE_POINTS ? 0 : longest2 <= SIX_POINTS ? 3 : 9;
    const int count = longest2 <= THREE_POINTS ? 3 : longest2 <= SIX_POINTS ? 6 : 12;
    const wave_float sum = integrate_by_points(a, first, count) + integrate_by_points(b, first, count);
    accumulate(&out->total, wave_select(zero, sum, valid));
    return;
  }
#if MICA_PRECISION > 0
  const wave_float along_x = max(dot4(a.m1, a.m1), dot4(b.m1, b.m1));
  const wave_float along_y = max(dot4(a.m2, a.m2), dot4(b.m2, b.m2));
  const float thickest2 = wave_max(wave_select(zero, min(along_x, along_y), valid), scratch);
  if (thickest2 <= THIN * THIN) {
    const wave_int swap = wave_mask(along_y < along_x);
    const wave_float sum = integrate_strips(swap_legs(a, swap), swap_legs(b, swap), sqrt(thickest2));
    accumulate(&out->total, wave_select(zero, sum, valid));
    return;
  }
#endif
  // Two whitenings of about 120 and four pairs of right triangles of about 40.
  if (MICA_COUNT_FLOPS) accumulate(&out->total, wave_select(zero, COUNTED(400, longest), valid));
  whitened_triangle u = whiten(a), v = whiten(b);
  u.q_plane = wave_select(cutoff + zero, min(u.q_plane, cutoff), valid);
  v.q_plane = wave_select(cutoff + zero, min(v.q_plane, cutoff), valid);
#define RIGHT(w, end) \
  make_right_triangles(w.t_apex, w.end - w.t_apex, w.x_base, w.altitude, w.q_plane, w.weight, cutoff)
  const right_triangles u1 = RIGHT(u, t_start), u2 = RIGHT(u, t_end), v1 = RIGHT(v, t_start),
                        v2 = RIGHT(v, t_end);
#undef RIGHT
  list_right_triangles(u1, out, scratch);
  list_right_triangles(u2, out, scratch);
  list_right_triangles(v1, out, scratch);
  list_right_triangles(v2, out, scratch);
}

#endif  // MICA_TRIANGLE_INTEGRAL_H
