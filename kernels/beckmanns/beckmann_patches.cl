// What the BRDF of a patch is made of, [Che18] Eq. 7, on a mixture of Beckmann lobes: the density D_P of its
// half vector, as beckmanns.cl has it, the areas I(o), I(i) that view and light see of its microsurface,
// [Che18] Eqs. 11-13, and the projected area of its mean normal: Eq. 17, but for its clamps, with which a
// patch of slopes without a mean would not have the cosine's.
//
// I is linear in the mean slope, o_z - p.o_xy, but for the lobes that lie close to edge-on or face away. So
// the mean comes from the pyramid of slopes, and only those lobes are visited besides; all of them where the
// footprint is too small for the pyramid, or seen so flat that the sum would be a small difference.

// 1: I is that of one lobe with the moments of the footprint's slopes, [Che18] sec. 4.2.2; 2: of every lobe.
#ifndef MICA_MASKING
#define MICA_MASKING 2
#endif
#if MICA_MASKING == 1
#define MICA_SLOPE_REACH 3.5f
#endif

#include "beckmanns/footprint_slopes.h"
#include "beckmanns/lobe_sum.h"
#include "beckmanns/visible_area.h"
#include "types.h"
#include "wave/wave.h"

// Least o_z - p.o_xy of the mean slope p at which most lobes are left out.
#define LEAST_FACING 0.1f
// Standard deviations beyond which a lobe faces a direction as a whole; it hides 6e-5 of its width.
#define FACING_DEVIATIONS 3.5f

// What a direction sees of lobes: the projected area of their mean normals, and the variance of that.
typedef struct {
  wave_float facing, variance;
} lobe_view;

typedef struct {
  lobe_sum density;
  lobe_view seen, lit;    // by view and light, of the leaf that is to be added next
  wave_float q_position;  // whitened squared distance of that leaf's lobes
  wave_float view, light, projected;
  int all;  // lobes are visited
} leaf_results;

// Lanes of the children with lobes that do not face direction (o_x, o_y, o_z) as a whole.
static inline wave_int turn_away(global const mica_lobe_query* query, const private lobe_children* c,
                                 float o_x, float o_y, float o_z) {
  const private oriented_boxes* b = &c->boxes;
  const wave_float o_1 = fma(b->axis_x, o_x, b->axis_y * o_y), o_2 = fma(b->axis_x, o_y, -(b->axis_y * o_x));
  const wave_float along_min =
      min(o_1 * b->along_min, o_1 * b->along_max) + min(o_2 * b->across_min, o_2 * b->across_max);
  const wave_float along_max =
      max(o_1 * b->along_min, o_1 * b->along_max) + max(o_2 * b->across_min, o_2 * b->across_max);
  const wave_float along = max(fabs(along_min), fabs(along_max));
  // o^T C o + sigma_r^2 |B o|^2 at most
  const wave_float stretch = c->w * fma((1.0f + c->w) * along, along, fma(o_x, o_x, o_y * o_y));
  const wave_float s_1 = b->spread_along * o_1, s_2 = b->spread_across * o_2;
  const float to_roughness = 1.0f / query->map.inverse_roughness;
  const wave_float variance =
      to_roughness * to_roughness * fma(query->spread_variance, fma(s_1, s_1, s_2 * s_2), stretch);
  const wave_float facing = max(o_z - along_max, 0.0f);
  return wave_mask(facing * facing <= FACING_DEVIATIONS * FACING_DEVIATIONS * variance);
}

// Bits of the children that matter to the density, and in the high half of those that matter to the areas.
static inline uint surviving_lobes(global const mica_patch_query* query, int all, global const short* node,
                                   int i, int j, int child_size, WAVE_SHARED int* scratch) {
  lobe_children c;
  load_children(&query->lobe, node, i, j, child_size, &c);
  const wave_int near = c.boxes.present & wave_mask(c.q_position <= query->lobe.map.cutoff);
  const uint dense = wave_ballot(matter_to_density(&query->lobe, &c), scratch);
  uint turned = 0;
  if (all) {
    turned = wave_ballot(near, scratch);
  } else if (MICA_MASKING == 2) {
    turned = wave_ballot(near & (turn_away(&query->lobe, &c, query->view_x, query->view_y, query->view_z) |
                                 turn_away(&query->lobe, &c, query->light_x, query->light_y, query->light_z)),
                         scratch);
  }
  return dense | turned << 16;
}

static inline void view_lobes(const private lobe_leaf* lobes, float roughness, float o_x, float o_y,
                              float o_z, private lobe_view* view) {
  const wave_float p_x = lobes->base_x + lobes->offset_x, p_y = lobes->base_y + lobes->offset_y;
  const wave_float along = fma(p_x, o_x, p_y * o_y);
  view->facing = o_z - along;
  // v = B o_xy; t^2 = v^T (S + sigma_r^2 I) v
  const wave_float w = fma(p_x, p_x, fma(p_y, p_y, 1.0f));
  const wave_float v_x = fma(along, p_x, o_x), v_y = fma(along, p_y, o_y);
  const wave_float l_1 = fma(lobes->spread_xx, v_x, lobes->spread_yx * v_y), l_2 = lobes->spread_yy * v_y;
  view->variance = (w * roughness * roughness) * fma(l_1, l_1, fma(l_2, l_2, fma(v_x, v_x, v_y * v_y)));
}

// Areas, less the part that is linear in the mean unless all lobes are visited.
static inline wave_float lobe_areas(const private lobe_view* view, int all) {
  const wave_float hidden = hidden_area(view->facing, max(view->variance, 1e-16f));
  return all ? max(view->facing + hidden, 0.0f) : hidden;
}

static inline void begin_areas(private leaf_results* results) {
  const wave_float zero = 0.0f, nowhere = NOWHERE;
  results->view = results->light = results->projected = zero;
  results->seen.facing = results->seen.variance = results->lit.facing = results->lit.variance = zero;
  results->q_position = nowhere;
}

// Adds the areas of the leaf that is under way.
static inline void add_areas(private leaf_results* results) {
  const wave_float weight = gaussian_exp2(max(-results->q_position, -126.0f));
  results->view = fma(weight, lobe_areas(&results->seen, results->all), results->view);
  results->light = fma(weight, lobe_areas(&results->lit, results->all), results->light);
  if (results->all) results->projected = fma(weight, results->lit.facing, results->projected);
}

// @param reasons why the leaf is visited: bit 0 for its density, bit 16 for its areas.
static inline void take_lobes(global const mica_patch_query* query, global const short* leaves, int leaf,
                              uint reasons, int i, int j, int room_i, int room_j,
                              private leaf_results* results) {
  lobe_leaf lobes;
  load_lobes(leaves + leaf * MICA_LOBE_LEAF, query->lobe.map.inverse_roughness, &lobes);
  const wave_float q_position = lobe_positions(&query->lobe.map, i, j, room_i, room_j);
  if (reasons & 1u) add_lobes(&query->lobe, &lobes, q_position, &results->density);
  if (!(reasons >> 16 & 1u)) return;
  add_areas(results);
  const float roughness = 1.0f / query->lobe.map.inverse_roughness;
  view_lobes(&lobes, roughness, query->view_x, query->view_y, query->view_z, &results->seen);
  view_lobes(&lobes, roughness, query->light_x, query->light_y, query->light_z, &results->lit);
  results->q_position = q_position;
}

#define LEAF_QUERY mica_patch_query
#define LEAF_PLACE(query) (&(query)->lobe.map)
#define LEAF_NODE_STRIDE MICA_MIXTURE_NODE_STRIDE
#define LEAF_DATA short
#define LEAF_AT(leaf_i, leaf_j) ((block.index * 16 + tile) * 16 + leaf)
#define LEAF_SURVIVORS(query, node, i, j, child_size, scratch) \
  surviving_lobes(query, results->all, node, i, j, child_size, scratch)
#define LEAF_TAKE(query, lobes, at, i, j, room_i, room_j, results, scratch) \
  take_lobes(query, lobes, at, reasons >> leaf, i, j, room_i, room_j, results)
#include "map/walk_leaves.h"

#if MICA_MASKING == 1
// For the density alone, which is all that is left to do once the pyramid has said the areas.
#define LEAF_WALK walk_dense_leaves
#define LEAF_RESULTS lobe_sum
#define LEAF_SURVIVORS(query, node, i, j, child_size, scratch) \
  dense_lobes(&(query)->lobe, node, i, j, child_size, scratch)
#define LEAF_TAKE(query, lobes, at, i, j, room_i, room_j, results, scratch) \
  sum_lobes(&(query)->lobe, lobes, at, i, j, room_i, room_j, results)
#include "map/walk_leaves.h"
#endif

// o_z - p.o_xy of the mean slope.
static inline float facing(slope_lobe lobe, float o_x, float o_y, float o_z) {
  return o_z - fma(lobe.mean_x, o_x, lobe.mean_y * o_y);
}

// The area of one lobe that a direction sees.
static inline float lobe_area(slope_lobe lobe, float o_x, float o_y, float o_z) {
  const float m = facing(lobe, o_x, o_y, o_z);
  const float variance = fma(lobe.xx * o_x, o_x, fma(2.0f * lobe.xy * o_x, o_y, lobe.yy * o_y * o_y));
  const wave_float wave_m = m, wave_variance = max(variance, 1e-16f);
  const wave_float hidden = hidden_area(wave_m, wave_variance);
#if MICA_WAVE_ITEMS
  return max(m + hidden, 0.0f);
#else
  return max(m + hidden.s0, 0.0f);
#endif
}

// D, I(view), I(light) and the light's projected area of every query, in the order of their slots. Global
// size: queries (vectors), or 16 a query (items).
WAVE_KERNEL void beckmann_patches(global const mica_patch_query* restrict queries, int query_count,
                                  mica_map_grid grid, global const short* restrict lobes,
                                  global const short* restrict block_nodes,
                                  global const short* restrict tile_nodes,
                                  global const short* restrict pyramid, global float* restrict answers) {
  WAVE_DECLARE_SCRATCH(scratch);
  if (WAVE_ITEM_INDEX >= query_count) return;
  global const mica_patch_query* query = queries + WAVE_ITEM_INDEX;
  leaf_results results;
  begin_lobes(&results.density);
  begin_areas(&results);
  results.all = query->slopes.offset < 0;
  float view = 0.0f, light = 0.0f, projected = 0.0f;
  if (!results.all) {
    slope_lobe lobe = footprint_slopes(&query->slopes, pyramid, scratch);
    if (MICA_MASKING == 1) {
      projected = max(facing(lobe, query->light_x, query->light_y, query->light_z), 0.0f);
      lobe = with_roughness(lobe, query->lobe.map.inverse_roughness, scratch);
      view = lobe_area(lobe, query->view_x, query->view_y, query->view_z);
      light = lobe_area(lobe, query->light_x, query->light_y, query->light_z);
    } else {
      view = facing(lobe, query->view_x, query->view_y, query->view_z);
      light = facing(lobe, query->light_x, query->light_y, query->light_z);
      results.all = min(view, light) < LEAST_FACING;
      if (results.all) view = light = 0.0f;
      projected = light;
    }
  }
#if MICA_MASKING == 1
  if (!results.all) {
    walk_dense_leaves(query, grid, lobes, block_nodes, tile_nodes, &results.density, scratch);
  } else
#endif
    walk_leaves(query, grid, lobes, block_nodes, tile_nodes, &results, scratch);
  add_areas(&results);
  global float* answer = answers + 4 * query->lobe.map.slot;
  answer[0] = query->lobe.map.scale * end_lobes(&query->lobe, &results.density, scratch);
  answer[1] = fma(query->weight, wave_sum(results.view, scratch), view);
  answer[2] = fma(query->weight, wave_sum(results.light, scratch), light);
  answer[3] = fma(query->weight, wave_sum(results.projected, scratch), projected);
}
