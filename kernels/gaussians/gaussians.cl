// `gaussians`: the P-NDF of a footprint on a mixture of 4D Gaussians in (position, normal), sliced in closed
// form. [Yan16]
//
// An element stands for a square of the map, of side h = 1 / MICA_ELEMENTS texels: centre c, mean normal s0
// and the normal's Jacobian J there, and a round position kernel of variance k. Its share of D is
//     h^2 N(c - m; F + k I) N(s - s0 - J A (m - c); sigma_r^2 I + J P J^T),   A = k (F + k I)^-1,   P = F A,
// with m and F the footprint's mean and covariance: one exponent an element. s0 and J are not stored: four
// texels say them. One wave a query; leaves of 4x4 texels survive the walk and are summed sixteen elements at
// a time, without a branch.

#include "map/map_cull.h"
#include "map/oriented_bound.h"
#include "map/quad_corners.h"
#include "types.h"
#include "wave/slice.h"
#include "wave/wave.h"

// Elements a texel and axis.
#ifndef MICA_ELEMENTS
#define MICA_ELEMENTS 1
#endif
#define ELEMENT_SIZE (1.0f / MICA_ELEMENTS)

// 1: the sum becomes the number of elements that were evaluated, for benchmarks.
#ifndef MICA_COUNT_ELEMENTS
#define MICA_COUNT_ELEMENTS 0
#endif

// 1: the half vector turns over the footprint, and the lobe need not be round: an element's normal less the
// half vector has the Jacobian J - H, and everything on the disk is whitened by the lobe.
#ifndef MICA_FIRST_ORDER
#define MICA_FIRST_ORDER 0
#endif
#if MICA_FIRST_ORDER
#include "map/turned_lobe.h"
typedef mica_turned_mixture_query mixture_query;
#define MIXTURE(query) (&(query)->mixture)
#else
typedef mica_mixture_query mixture_query;
#define MIXTURE(query) (query)
#endif

// Bits of the children of `node` that reach the cutoff; centres lie half an element inside the children.
static inline uint surviving_elements(global const mixture_query* query, global const short* node, int i,
                                      int j, int child_size, WAVE_SHARED int* scratch) {
  global const mica_map_query* place = &MIXTURE(query)->map;
  oriented_boxes boxes;
  load_boxes(node, 1.0f, &boxes);
  const float to_bound = (float)MICA_BOUND_ONE / MICA_NORMAL_ONE;
  const wave_float x =
      wave_to_float(i + (WAVE_LANE & 3) * child_size) - (place->mean_x - 0.5f * ELEMENT_SIZE);
  const wave_float y =
      wave_to_float(j + (WAVE_LANE >> 2) * child_size) - (place->mean_y - 0.5f * ELEMENT_SIZE);
  const wave_float q_position = footprint_bound(place, x, y, child_size - ELEMENT_SIZE);
#if MICA_FIRST_ORDER
  // The half vector at the middle of a child; how far it turns from there widens the box, and spreads
  // elements.
  const float half_size = 0.5f * (child_size - ELEMENT_SIZE);
  const wave_float middle_x = x + half_size, middle_y = y + half_size;
  const wave_float h_s =
      to_bound * place->half_s + MICA_BOUND_ONE * fma(query->turn_sx, middle_x, query->turn_sy * middle_y);
  const wave_float h_t =
      to_bound * place->half_t + MICA_BOUND_ONE * fma(query->turn_tx, middle_x, query->turn_ty * middle_y);
  const float widening = half_size * MICA_BOUND_ONE;
  widen_boxes(&boxes, widening * (fabs(query->turn_sx) + fabs(query->turn_sy)),
              widening * (fabs(query->turn_tx) + fabs(query->turn_ty)));
  const wave_float rough = 1.0f + query->spread_turn;
  return wave_ballot(reach_cutoff_of(&boxes, h_s, h_t, place->inverse_roughness / MICA_BOUND_ONE,
                                     query->mixture.spread_variance, rough, q_position, place->cutoff),
                     scratch);
#else
  const wave_float one = 1.0f;
  return wave_ballot(reach_cutoff(&boxes, place->half_s * to_bound, place->half_t * to_bound,
                                  place->inverse_roughness / MICA_BOUND_ONE, query->spread_variance, one,
                                  q_position, place->cutoff),
                     scratch);
#endif
}

// Sixteen elements, one of each quad of a leaf. Lengths are times EXP2_SCALE, so that exponents are of 2.
typedef struct {
  wave_float p1, p2;    // centres less the footprint's mean, whitened
  wave_float e_s, e_t;  // the half vector less s0, in roughnesses or, of a turned lobe, whitened
  wave_float jx_s, jx_t, jy_s, jy_t;  // twice the columns of J a texel, in fixed point
} element_wave;

// What a query's slices have in common, and their sum.
typedef struct {
  float a1x, a1y, a2x, a2y;  // a_i / tau_i
  float pull_1x, pull_1y, pull_2x,
      pull_2y;           // k a_i / tau_i over the roughness, for twice a Jacobian in fixed point
  float blur_1, blur_2;  // the query's, for what has been pulled
  float to_roughness;
  wave_float lane_1, lane_2;  // p1 and p2 of a lane's place in its leaf
  int leaves;
  element_wave loaded;
  slice_wave sliced;
  wave_float sum;
} leaf_results;

static inline void begin_slices(global const mica_mixture_query* query, private leaf_results* results) {
  results->a1x = EXP2_SCALE * query->axis_1x, results->a1y = EXP2_SCALE * query->axis_1y;
  results->a2x = EXP2_SCALE * query->axis_2x, results->a2y = EXP2_SCALE * query->axis_2y;
  const wave_float column = wave_to_float(WAVE_LANE & 3), row = wave_to_float(WAVE_LANE >> 2), zero = 0.0f;
  results->lane_1 = fma(column, results->a1x, row * results->a1y),
  results->lane_2 = fma(column, results->a2x, row * results->a2y);
  const float inverse_roughness = MICA_FIRST_ORDER ? 1.0f : query->map.inverse_roughness;
  const float pull = query->kernel_variance * inverse_roughness, to_pull = 0.5f / MICA_NORMAL_ONE * pull;
  results->pull_1x = to_pull * query->axis_1x, results->pull_1y = to_pull * query->axis_1y;
  results->pull_2x = to_pull * query->axis_2x, results->pull_2y = to_pull * query->axis_2y;
  results->blur_1 = query->blur_1 / pull, results->blur_2 = query->blur_2 / pull;
  results->to_roughness = EXP2_SCALE / MICA_NORMAL_ONE * inverse_roughness;
  results->leaves = 0;
  results->loaded.p1 = NOWHERE, results->loaded.p2 = results->loaded.e_s = results->loaded.e_t = zero;
  results->loaded.jx_s = results->loaded.jx_t = results->loaded.jy_s = results->loaded.jy_t = zero;
  results->sliced.q_position = NOWHERE, results->sliced.form = zero, results->sliced.det = 1.0f;
  results->sum = zero;
}

static inline void slice_elements(private const leaf_results* by, private const element_wave* e,
                                  private slice_wave* slice) {
  // J a_i / tau_i, pulled: times p_i what the residual s - s0 - J A (m - c) moves by, whose m - c is -p.
  const wave_float v1_s = fma(e->jx_s, by->pull_1x, e->jy_s * by->pull_1y);
  const wave_float v1_t = fma(e->jx_t, by->pull_1x, e->jy_t * by->pull_1y);
  const wave_float v2_s = fma(e->jx_s, by->pull_2x, e->jy_s * by->pull_2y);
  const wave_float v2_t = fma(e->jx_t, by->pull_2x, e->jy_t * by->pull_2y);
  const wave_float r_s = fma(e->p1, v1_s, fma(e->p2, v2_s, e->e_s)),
                   r_t = fma(e->p1, v1_t, fma(e->p2, v2_t, e->e_t));
  // I + M M^T is the covariance in roughnesses; its determinant and its inverse's form, without cancellation.
  const wave_float m1_s = by->blur_1 * v1_s, m1_t = by->blur_1 * v1_t, m2_s = by->blur_2 * v2_s,
                   m2_t = by->blur_2 * v2_t;
  const wave_float det_m = fma(m1_s, m2_t, -(m1_t * m2_s));
  slice->det = fma(det_m, det_m, fma(m1_s, m1_s, fma(m1_t, m1_t, fma(m2_s, m2_s, fma(m2_t, m2_t, 1.0f)))));
  const wave_float cross_1 = fma(r_s, m1_t, -(r_t * m1_s)), cross_2 = fma(r_s, m2_t, -(r_t * m2_s));
  slice->form = fma(r_s, r_s, fma(r_t, r_t, fma(cross_1, cross_1, cross_2 * cross_2)));
  slice->q_position = fma(e->p1, e->p1, e->p2 * e->p2);
}

// The three steps, each of another wave of elements.
static inline void advance(private leaf_results* results, private const element_wave* next) {
  results->sum += slice_density(&results->sliced);
  slice_elements(results, &results->loaded, &results->sliced);
  results->loaded = *next;
}

#if MICA_FIRST_ORDER
// Whitens sixteen elements, one a texel of a leaf, of which the first has its centre at (x, y).
static inline void turn_elements(global const mica_turned_lobe* lobe, float x, float y,
                                 private element_wave* e) {
  const wave_float column = wave_to_float(WAVE_LANE & 3), row = wave_to_float(WAVE_LANE >> 2);
  // The half vector less s0 becomes longer with place, by as much as s0 less it becomes shorter.
  whiten_normals(lobe, -EXP2_SCALE * (x + column), -EXP2_SCALE * (y + row), &e->e_s, &e->e_t);
  const wave_float zero = 0.0f, twice = 2.0f * MICA_NORMAL_ONE;
  whiten_normals(lobe, twice, zero, &e->jx_s, &e->jx_t);
  whiten_normals(lobe, zero, twice, &e->jy_s, &e->jy_t);
}
#define TURN_ELEMENTS(query, x, y, next) turn_elements(&(query)->lobe, x, y, next)
#else
#define TURN_ELEMENTS(query, x, y, next)
#endif

// The elements of a leaf whose lower left texel is stored at `at` and lies (i, j) texels from the mean.
static inline void take_elements(global const mixture_query* query, global const int* normals, int at, int i,
                                 int j, int room_i, int room_j, private leaf_results* results) {
  global const mica_map_query* place = &MIXTURE(query)->map;
  quad_corners c;
  load_corners(normals, at, &c);
  // The bilinear patch s00 + x f + y g + (xy - x - y) f g. Differences of fixed-point numbers are exact:
  // rounding begins here.
  const wave_float x_s = wave_to_float(c.s10 - c.s00), y_s = wave_to_float(c.s01 - c.s00),
                   xy_s = wave_to_float(c.s11 - c.s00);
  const wave_float x_t = wave_to_float(c.t10 - c.t00), y_t = wave_to_float(c.t01 - c.t00),
                   xy_t = wave_to_float(c.t11 - c.t00);
  const float to_roughness = results->to_roughness;
  const wave_float e_s = to_roughness * wave_to_float(place->half_s - c.s00);
  const wave_float e_t = to_roughness * wave_to_float(place->half_t - c.t00);
  const float x = i - place->mean_x, y = j - place->mean_y;
  wave_float lane_1 = results->lane_1;
  if (room_i < MICA_LEAF || room_j < MICA_LEAF) {
    const wave_float nowhere = NOWHERE;
    lane_1 = wave_select(nowhere, lane_1,
                         wave_mask((WAVE_LANE & 3) < room_i) & wave_mask((WAVE_LANE >> 2) < room_j));
  }
  ++results->leaves;
  element_wave next;
#if MICA_ELEMENTS == 1
  const wave_float turn_s = x_s - y_s, turn_t = x_t - y_t;
  next.p1 = lane_1 + fma(x + 0.5f, results->a1x, (y + 0.5f) * results->a1y);
  next.p2 = results->lane_2 + fma(x + 0.5f, results->a2x, (y + 0.5f) * results->a2y);
  next.e_s = fma(-0.25f * to_roughness, x_s + y_s + xy_s, e_s),
  next.e_t = fma(-0.25f * to_roughness, x_t + y_t + xy_t, e_t);
  next.jx_s = xy_s + turn_s, next.jx_t = xy_t + turn_t, next.jy_s = xy_s - turn_s, next.jy_t = xy_t - turn_t;
  TURN_ELEMENTS(query, x + 0.5f, y + 0.5f, &next);
  advance(results, &next);
#else
  const wave_float bend_s = xy_s - x_s - y_s, bend_t = xy_t - x_t - y_t;
  for (int b = 0; b < MICA_ELEMENTS; ++b) {
    for (int a = 0; a < MICA_ELEMENTS; ++a) {
      const float f = (a + 0.5f) * ELEMENT_SIZE, g = (b + 0.5f) * ELEMENT_SIZE;
      next.p1 = lane_1 + fma(x + f, results->a1x, (y + g) * results->a1y);
      next.p2 = results->lane_2 + fma(x + f, results->a2x, (y + g) * results->a2y);
      const wave_float jx_s = fma(bend_s, g, x_s), jx_t = fma(bend_t, g, x_t);
      next.e_s = fma(-to_roughness, fma(jx_s, f, y_s * g), e_s),
      next.e_t = fma(-to_roughness, fma(jx_t, f, y_t * g), e_t);
      next.jx_s = 2.0f * jx_s, next.jy_s = 2.0f * fma(bend_s, f, y_s);
      next.jx_t = 2.0f * jx_t, next.jy_t = 2.0f * fma(bend_t, f, y_t);
      TURN_ELEMENTS(query, x + f, y + g, &next);
      advance(results, &next);
    }
  }
#endif
}

#define LEAF_QUERY mixture_query
#define LEAF_PLACE(query) (&MIXTURE(query)->map)
#define LEAF_NODE_STRIDE MICA_MIXTURE_NODE_STRIDE
#define LEAF_SURVIVORS surviving_elements
#define LEAF_TAKE(query, normals, at, i, j, room_i, room_j, sum, scratch) \
  take_elements(query, normals, at, i, j, room_i, room_j, sum)
#include "map/walk_leaves.h"

// Density of every query, in the order of their slots. Global size: queries (vectors), or 16 a query (items).
WAVE_KERNEL void gaussians(global const mixture_query* restrict queries, int query_count, mica_map_grid grid,
                           global const int* restrict normals, global const short* restrict block_nodes,
                           global const short* restrict tile_nodes, global float* restrict density) {
  WAVE_DECLARE_SCRATCH(scratch);
  if (WAVE_ITEM_INDEX >= query_count) return;
  global const mixture_query* query = queries + WAVE_ITEM_INDEX;
  global const mica_map_query* place = &MIXTURE(query)->map;
  leaf_results results;
  begin_slices(MIXTURE(query), &results);
  walk_leaves(query, grid, normals, block_nodes, tile_nodes, &results, scratch);
  const element_wave none = results.loaded;
  for (int step = 0; step < 2; ++step) advance(&results, &none);
  const float total = results.leaves > 0 ? wave_sum(results.sum, scratch) : 0.0f;
#if MICA_COUNT_ELEMENTS
  density[place->slot] = results.leaves * (float)(WAVE_LANES * MICA_ELEMENTS * MICA_ELEMENTS);
#else
  density[place->slot] = place->scale * total;
#endif
}
