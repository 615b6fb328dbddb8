// `triangles`: the P-NDF of a footprint on a triangulated normal map. [Yan14] Eq. 6.
//
// One wave a query. Blocks of 64x64 texels under the footprint are culled sixteen children at a time: block
// -> tiles of 16x16 -> leaves of 4x4 -> quads. The quads that remain gather in a list and are integrated
// sixteen at a time.

#include "map/map_cull.h"
#include "triangles/right_triangles.h"
#include "triangles/triangle_integral.h"
#include "types.h"
#include "wave/wave_list.h"

// 0: a constant texel, 1: two triangles a quad, 2: Catmull-Rom, 4x4 sub-quads of two triangles each.
#ifndef MICA_INTERPOLATION
#define MICA_INTERPOLATION 1
#endif

// 1: the half vector turns over the footprint, and the lobe need not be round.
#ifndef MICA_FIRST_ORDER
#define MICA_FIRST_ORDER 0
#endif
#if MICA_FIRST_ORDER
#include "map/turned_lobe.h"
typedef mica_turned_query triangle_query;
#define PLACE(query) (&(query)->map)
#define LEAF_SURVIVORS turned_children
#else
typedef mica_map_query triangle_query;
#define PLACE(query) (query)
#define LEAF_SURVIVORS surviving_children
#endif

// Sixteen quads: lower left corner in texels from the mean; normals less the half vector, in standard
// deviations of the lobe, at the corners 00, 10, 01, 11 (x first).
typedef struct {
  wave_float x, y;
  wave_float s00, s10, s01, s11;
  wave_float t00, t10, t01, t11;
} quads;
#define QUAD_SIZE (MICA_INTERPOLATION == 2 ? 0.25f : 1.0f)

#if MICA_FIRST_ORDER || MICA_INTERPOLATION == 2
// Lower bound of the squared length of the whitened residual on both triangles of each quad.
static inline wave_float quads_bound(global const mica_map_query* query, private const quads* q) {
  const wave_float b_s =
      max(max(min(min(q->s00, q->s10), min(q->s01, q->s11)), -max(max(q->s00, q->s10), max(q->s01, q->s11))),
          0.0f);
  const wave_float b_t =
      max(max(min(min(q->t00, q->t10), min(q->t01, q->t11)), -max(max(q->t00, q->t10), max(q->t01, q->t11))),
          0.0f);
  return fma(b_s, b_s, fma(b_t, b_t, footprint_bound(query, q->x, q->y, QUAD_SIZE)));
}
#endif

#if MICA_FIRST_ORDER
// Normals less the half vector become whitened ones.
static inline void whiten_quads(global const triangle_query* query, private quads* q) {
  global const mica_turned_lobe* lobe = &query->lobe;
  const wave_float right = q->x + QUAD_SIZE, upper = q->y + QUAD_SIZE;
  whiten_normals(lobe, q->x, q->y, &q->s00, &q->t00), whiten_normals(lobe, right, q->y, &q->s10, &q->t10);
  whiten_normals(lobe, q->x, upper, &q->s01, &q->t01), whiten_normals(lobe, right, upper, &q->s11, &q->t11);
}
#endif

// Both triangles of each quad in lanes where `valid` is set; the diagonal runs from 10 to 01.
static inline void integrate_quads(global const mica_map_query* query, private const quads* q, wave_int valid,
                                   private integrator* out, WAVE_SHARED int* scratch) {
  const float w1x = QUAD_SIZE * query->whiten_1x, w1y = QUAD_SIZE * query->whiten_1y;
  const float w2x = QUAD_SIZE * query->whiten_2x, w2y = QUAD_SIZE * query->whiten_2y;
  affine_residual lower, upper;
  lower.r0.p1 = fma(q->x, query->whiten_1x, q->y * query->whiten_1y);
  lower.r0.p2 = fma(q->x, query->whiten_2x, q->y * query->whiten_2y);
  lower.r0.s = q->s00, lower.r0.t = q->t00;
  lower.m1.p1 = w1x, lower.m1.p2 = w2x, lower.m1.s = q->s10 - q->s00, lower.m1.t = q->t10 - q->t00;
  lower.m2.p1 = w1y, lower.m2.p2 = w2y, lower.m2.s = q->s01 - q->s00, lower.m2.t = q->t01 - q->t00;
  upper.r0.p1 = lower.r0.p1 + w1x + w1y, upper.r0.p2 = lower.r0.p2 + w2x + w2y;
  upper.r0.s = q->s11, upper.r0.t = q->t11;
  upper.m1.p1 = -w1x, upper.m1.p2 = -w2x, upper.m1.s = q->s01 - q->s11, upper.m1.t = q->t01 - q->t11;
  upper.m2.p1 = -w1y, upper.m2.p2 = -w2y, upper.m2.s = q->s10 - q->s11, upper.m2.t = q->t10 - q->t11;
  integrate_triangle_pairs(lower, upper, valid, query->cutoff, out, scratch);
}

// Quads wait until there are sixteen of them: those that are cheap to integrate, and the others.
#define QUAD_FIELDS 10
typedef struct {
  wave_list thin, other;
} waiting_quads;

static inline void load_first_quads(wave_list list, private quads* q) {
  q->x = wave_list_field(list, 0), q->y = wave_list_field(list, 1);
  q->s00 = wave_list_field(list, 2), q->s10 = wave_list_field(list, 3);
  q->s01 = wave_list_field(list, 4), q->s11 = wave_list_field(list, 5);
  q->t00 = wave_list_field(list, 6), q->t10 = wave_list_field(list, 7);
  q->t01 = wave_list_field(list, 8), q->t11 = wave_list_field(list, 9);
}

static inline void integrate_first_quads(global const mica_map_query* query, private wave_list* list,
                                         private integrator* out, WAVE_SHARED int* scratch) {
  quads q;
  load_first_quads(*list, &q);
  const wave_int valid = wave_mask(WAVE_LANE < list->count);
  wave_list_drop(list, QUAD_FIELDS);
  integrate_quads(query, &q, valid, out, scratch);
}

static inline void append_quads(private const quads* q, uint bits, private wave_list* list) {
  wave_list_pack(*list, 0, bits, q->x), wave_list_pack(*list, 1, bits, q->y);
  wave_list_pack(*list, 2, bits, q->s00), wave_list_pack(*list, 3, bits, q->s10);
  wave_list_pack(*list, 4, bits, q->s01), wave_list_pack(*list, 5, bits, q->s11);
  wave_list_pack(*list, 6, bits, q->t00), wave_list_pack(*list, 7, bits, q->t10);
  wave_list_pack(*list, 8, bits, q->t01), wave_list_pack(*list, 9, bits, q->t11);
  wave_list_count(list, bits);
}

// Integrates the quads in `bits`: at once when all sixteen are, later in company when not.
static inline void take_quads_alike(global const mica_map_query* query, private const quads* q, uint bits,
                                    private wave_list* list, private integrator* out,
                                    WAVE_SHARED int* scratch) {
  if (bits == 0) return;
  if (bits == 0xffffu) {
    integrate_quads(query, q, wave_mask(WAVE_LANE >= 0), out, scratch);
    return;
  }
  append_quads(q, bits, list);
  if (list->count >= WAVE_LANES) integrate_first_quads(query, list, out, scratch);
}

#if MICA_PRECISION > 0
// Bits of the quads that are thin: strips take them when no other quad is in the wave.
static inline uint thin_quads(global const mica_map_query* query, private const quads* q,
                              WAVE_SHARED int* scratch) {
#define EDGE(a, b) fma(q->s##a - q->s##b, q->s##a - q->s##b, (q->t##a - q->t##b) * (q->t##a - q->t##b))
  const float w1x = QUAD_SIZE * query->whiten_1x, w1y = QUAD_SIZE * query->whiten_1y;
  const float w2x = QUAD_SIZE * query->whiten_2x, w2y = QUAD_SIZE * query->whiten_2y;
  const wave_float along_x = fma(w1x, w1x, w2x * w2x) + max(EDGE(00, 10), EDGE(01, 11));
  const wave_float along_y = fma(w1y, w1y, w2y * w2y) + max(EDGE(00, 01), EDGE(10, 11));
#undef EDGE
  return wave_ballot(wave_mask(min(along_x, along_y) <= THIN * THIN), scratch);
}
#endif

static inline void take_quads(global const mica_map_query* query, private const quads* q, uint bits,
                              private waiting_quads* waiting, private integrator* out,
                              WAVE_SHARED int* scratch) {
#if MICA_PRECISION > 0
  const uint thin = bits & thin_quads(query, q, scratch);
  take_quads_alike(query, q, thin, &waiting->thin, out, scratch);
  bits &= ~thin;
#endif
  take_quads_alike(query, q, bits, &waiting->other, out, scratch);
}

// What still waits: together, where that is one wave.
static inline void integrate_waiting(global const mica_map_query* query, private waiting_quads* waiting,
                                     private integrator* out, WAVE_SHARED int* scratch) {
  const int thin = waiting->thin.count;
  if (thin && waiting->other.count && thin + waiting->other.count <= WAVE_LANES) {
    quads q;
    load_first_quads(waiting->thin, &q);
    append_quads(&q, (1u << thin) - 1u, &waiting->other);
    waiting->thin.count = 0;
  }
  if (waiting->thin.count) integrate_first_quads(query, &waiting->thin, out, scratch);
  if (waiting->other.count) integrate_first_quads(query, &waiting->other, out, scratch);
}

#if MICA_INTERPOLATION == 2
#include "map/catmull_rom.h"
#else
#include "map/texel_quads.h"
#endif

typedef struct {
  waiting_quads waiting;
  integrator out;
} leaf_results;

#define LEAF_TAKE(query, normals, at, i, j, room_i, room_j, gathered, scratch) \
  take_leaf(query, normals, at, i, j, room_i, room_j, &(gathered)->waiting, &(gathered)->out, scratch)
#define LEAF_QUERY triangle_query
#define LEAF_PLACE PLACE
#define LEAF_NODE_STRIDE MICA_NODE_STRIDE
#include "map/walk_leaves.h"

// Density of every query, in the order of their slots. Global size: queries (vectors), or 16 a query (items).
WAVE_KERNEL void triangles(global const triangle_query* restrict queries, int query_count, mica_map_grid grid,
                           global const int* restrict normals, global const short* restrict block_nodes,
                           global const short* restrict tile_nodes, global float* restrict density) {
  WAVE_DECLARE_SCRATCH(scratch);
  WAVE_SHARED float short_records[RIGHT_RECORDS], long_records[RIGHT_RECORDS];
  WAVE_SHARED float thin_records[QUAD_FIELDS * WAVE_LIST], other_records[QUAD_FIELDS * WAVE_LIST];
  if (WAVE_ITEM_INDEX >= query_count) return;
  global const triangle_query* query = queries + WAVE_ITEM_INDEX;
  global const mica_map_query* place = PLACE(query);
  leaf_results gathered = {{{thin_records, 0}, {other_records, 0}},
                           {{0.0f, 0.0f}, {short_records, 0}, {long_records, 0}}};
  walk_leaves(query, grid, normals, block_nodes, tile_nodes, &gathered, scratch);
  integrate_waiting(place, &gathered.waiting, &gathered.out, scratch);
  integrate_rest(&gathered.out, scratch);
  const float sum = wave_sum(gathered.out.total.sum, scratch);
  const float area = QUAD_SIZE * QUAD_SIZE;  // area of a quad: the integrals are over unit triangles
  density[place->slot] = MICA_COUNT_FLOPS ? sum : place->scale * area * sum;
}
