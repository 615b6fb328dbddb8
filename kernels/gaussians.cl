// `gaussians`: the P-NDF of a footprint on a mixture of 4D Gaussians in (position, normal), sliced in closed form. [Yan16]
//
// An element stands for a square of the map, of side h = 1 / MICA_ELEMENTS texels: centre c, mean normal s0 and the
// normal's Jacobian J there, and a round position kernel of variance k. Its share of D is
//     h^2 N(c - m; F + k I) N(s - s0 - J A (m - c); sigma_r^2 I + J P J^T),   A = k (F + k I)^-1,   P = F A,
// with m and F the footprint's mean and covariance: one exponent an element. s0 and J are not stored: four texels say them.
// One wave a query; leaves of 4x4 texels survive the walk and are summed sixteen elements at a time, without a branch.

#include "gaussian.h"
#include "map_cull.h"
#include "oriented_bound.h"
#include "types.h"
#include "wave.h"

// 0: constant texels, whose elements have no Jacobian; 1: bilinear quads between the centres of texels.
#ifndef MICA_INTERPOLATION
#define MICA_INTERPOLATION 1
#endif
// Elements a texel and axis.
#ifndef MICA_ELEMENTS
#define MICA_ELEMENTS 1
#endif
#define ELEMENT_SIZE (1.0f / MICA_ELEMENTS)

// 1: the sum becomes the number of elements that were evaluated, for benchmarks.
#ifndef MICA_COUNT_ELEMENTS
#define MICA_COUNT_ELEMENTS 0
#endif

// Bits of the children of `node` that reach the cutoff; centres lie half an element inside the children.
static inline uint surviving_elements(global const mica_mixture_query* query, global const short* node, int i, int j,
                                      int child_size, WAVE_SHARED int* scratch) {
  global const mica_map_query* place = &query->map;
  oriented_boxes boxes;
  load_boxes(node, 1.0f, &boxes);
  const float to_bound = (float)MICA_BOUND_ONE / MICA_NORMAL_ONE;
  const wave_float x = wave_to_float(i + (WAVE_LANE & 3) * child_size) - (place->mean_x - 0.5f * ELEMENT_SIZE);
  const wave_float y = wave_to_float(j + (WAVE_LANE >> 2) * child_size) - (place->mean_y - 0.5f * ELEMENT_SIZE);
  const wave_float q_position = footprint_bound(place, x, y, child_size - ELEMENT_SIZE), one = 1.0f;
  return wave_ballot(reach_cutoff(&boxes, place->half_s * to_bound, place->half_t * to_bound,
                                  place->inverse_roughness / MICA_BOUND_ONE, query->spread_variance, one, q_position,
                                  place->cutoff),
                     scratch);
}

// Sixteen elements, one of each quad of a leaf. `x`, `y`: centres less the footprint's mean, texels. `e`: the half vector
// less s0; `jx`, `jy`: columns of J a texel; all in fixed-point units. Without the query's scale.
static inline wave_float slice_elements(global const mica_mixture_query* query, wave_float x, wave_float y,
                                        wave_float e_s, wave_float e_t, wave_float jx_s, wave_float jx_t,
                                        wave_float jy_s, wave_float jy_t) {
  const float to_roughness = query->map.inverse_roughness / MICA_NORMAL_ONE;
  const wave_float p1 = fma(x, query->axis_1x, y * query->axis_1y);
  const wave_float p2 = fma(x, query->axis_2x, y * query->axis_2y);
  // J a_i / tau_i
  const wave_float v1_s = fma(jx_s, query->axis_1x, jy_s * query->axis_1y);
  const wave_float v1_t = fma(jx_t, query->axis_1x, jy_t * query->axis_1y);
  const wave_float v2_s = fma(jx_s, query->axis_2x, jy_s * query->axis_2y);
  const wave_float v2_t = fma(jx_t, query->axis_2x, jy_t * query->axis_2y);
  // The residual s - s0 - J A (m - c) in roughnesses; m - c = -(x, y).
  const wave_float k1 = query->kernel_variance * p1, k2 = query->kernel_variance * p2;
  const wave_float r_s = to_roughness * fma(k1, v1_s, fma(k2, v2_s, e_s));
  const wave_float r_t = to_roughness * fma(k1, v1_t, fma(k2, v2_t, e_t));
  // I + M M^T is the covariance in roughnesses; its determinant and its inverse's form, without cancellation.
  const float blur_1 = query->blur_1 / MICA_NORMAL_ONE, blur_2 = query->blur_2 / MICA_NORMAL_ONE;
  const wave_float m1_s = blur_1 * v1_s, m1_t = blur_1 * v1_t, m2_s = blur_2 * v2_s, m2_t = blur_2 * v2_t;
  const wave_float det_m = fma(m1_s, m2_t, -(m1_t * m2_s));
  const wave_float det = fma(det_m, det_m, fma(m1_s, m1_s, fma(m1_t, m1_t, fma(m2_s, m2_s, fma(m2_t, m2_t, 1.0f)))));
  const wave_float cross_1 = fma(r_s, m1_t, -(r_t * m1_s)), cross_2 = fma(r_s, m2_t, -(r_t * m2_s));
  const wave_float form = fma(r_s, r_s, fma(r_t, r_t, fma(cross_1, cross_1, cross_2 * cross_2)));
  const wave_float inverse_root = wave_rsqrt(det);
  const wave_float q = fma(form * inverse_root, inverse_root, fma(p1, p1, p2 * p2));
  return inverse_root * gaussian_exp2(max((-EXP2_SCALE * EXP2_SCALE) * q, -126.0f));
}

typedef wave_float leaf_results;

// The elements of a leaf whose lower left texel is stored at `at` and lies (i, j) texels from the mean.
static inline void take_elements(global const mica_mixture_query* query, global const int* normals, int at, int i, int j,
                                 int room_i, int room_j, private wave_float* sum) {
  const wave_int column = WAVE_LANE & 3, row = WAVE_LANE >> 2;
  const wave_int inside_map = wave_mask(column < room_i) & wave_mask(row < room_j);
  const wave_float x = wave_to_float(i + column) - query->map.mean_x, y = wave_to_float(j + row) - query->map.mean_y;
  global const int* s = normals + at;
  global const int* t = s + MICA_BLOCK_PLANE;
  wave_int s00, s10, t00, t10;
  wave_load_4x4_pair(s, MICA_BLOCK_ROW, &s00, &s10);
  wave_load_4x4_pair(t, MICA_BLOCK_ROW, &t00, &t10);
  // Exact differences of fixed-point numbers: rounding begins here.
  const wave_float e_s = wave_to_float(query->map.half_s - s00), e_t = wave_to_float(query->map.half_t - t00);
#if MICA_INTERPOLATION == 0
  const wave_float x_s = 0.0f, y_s = 0.0f, xy_s = 0.0f, x_t = 0.0f, y_t = 0.0f, xy_t = 0.0f;
#else
  wave_int s01, s11, t01, t11;
  wave_load_4x4_pair(s + MICA_BLOCK_ROW, MICA_BLOCK_ROW, &s01, &s11);
  wave_load_4x4_pair(t + MICA_BLOCK_ROW, MICA_BLOCK_ROW, &t01, &t11);
  // The bilinear patch s00 + x_s f + y_s g + xy_s f g.
  const wave_float x_s = wave_to_float(s10 - s00), y_s = wave_to_float(s01 - s00);
  const wave_float x_t = wave_to_float(t10 - t00), y_t = wave_to_float(t01 - t00);
  const wave_float xy_s = wave_to_float(s11 - s00) - x_s - y_s, xy_t = wave_to_float(t11 - t00) - x_t - y_t;
#endif
  wave_float leaf_sum = 0.0f;
  for (int b = 0; b < MICA_ELEMENTS; ++b) {
    for (int a = 0; a < MICA_ELEMENTS; ++a) {
      const float f = (a + 0.5f) * ELEMENT_SIZE, g = (b + 0.5f) * ELEMENT_SIZE;
      const wave_float jx_s = fma(xy_s, g, x_s), jx_t = fma(xy_t, g, x_t);
      const wave_float jy_s = fma(xy_s, f, y_s), jy_t = fma(xy_t, f, y_t);
      leaf_sum += slice_elements(query, x + f, y + g, e_s - fma(jx_s, f, y_s * g), e_t - fma(jx_t, f, y_t * g), jx_s,
                                 jx_t, jy_s, jy_t);
    }
  }
  const wave_float nothing = 0.0f, count = MICA_ELEMENTS * MICA_ELEMENTS;
  *sum += wave_select(nothing, MICA_COUNT_ELEMENTS ? count : leaf_sum, inside_map);
}

#define LEAF_QUERY mica_mixture_query
#define LEAF_PLACE(query) (&(query)->map)
#define LEAF_NODE_STRIDE MICA_MIXTURE_NODE_STRIDE
#define LEAF_SURVIVORS surviving_elements
#define LEAF_TAKE(query, normals, at, i, j, room_i, room_j, sum, scratch) \
  take_elements(query, normals, at, i, j, room_i, room_j, sum)
#include "walk_leaves.h"

// Density of every query, in the order of their slots. Global size: queries (vectors), or 16 a query (items).
kernel void gaussians(global const mica_mixture_query* restrict queries, int query_count, mica_map_grid grid,
                      global const int* restrict normals, global const short* restrict block_nodes,
                      global const short* restrict tile_nodes, global float* restrict density) {
  WAVE_DECLARE_SCRATCH(scratch);
  if (WAVE_ITEM_INDEX >= query_count) return;
  global const mica_mixture_query* query = queries + WAVE_ITEM_INDEX;
  wave_float sum = 0.0f;
  walk_leaves(query, grid, normals, block_nodes, tile_nodes, &sum, scratch);
  const float total = wave_sum(sum, scratch);
  density[query->map.slot] = MICA_COUNT_ELEMENTS ? total : query->map.scale * total;
}
