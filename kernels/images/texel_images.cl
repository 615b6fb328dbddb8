// Images of P-NDFs from the texels themselves, for footprints that are wide in texels and roughnesses too
// small to merge.
//
// Both triangles of a quad are cut into n^2 pieces so small that a Gaussian can stand for each: mean (c, s),
// covariance P of the position, and of the normal J P J^T, J the normal's Jacobian on the triangle. A piece's
// share of D is that of pyramid.cl's elements with K = J P. All pieces have the same P, so that only J and
// the mean differ from lane to lane:
//     w N(m - c; P + F) N(h - s - J P A (m - c); sigma_r^2 I + J Q J^T),   A = (P + F)^-1,  Q = P - P A P.
// One wave a band of an image.

#include "images/splat.h"
#include "map/quad_corners.h"

// Normals may change by this many roughnesses over a piece; triangles are cut into MOST_CUTS^2 pieces at
// most: where normals change faster they are spread too thin for their pieces' shape to matter.
#define PIECE_ROUGHNESSES 3.0f
#define MOST_CUTS 8

// Bits of the children of `node` with pieces that reach the cutoff: as surviving_records, with half the
// bound's weight.
static inline uint surviving_texels(global const mica_pyramid_query* query, half_vector_box half_vectors,
                                    global const short* node, int i, int j, int child_size,
                                    WAVE_SHARED int* scratch) {
  const wave_float s_min = wave_to_float(wave_load_short(node)),
                   s_max = wave_to_float(wave_load_short(node + 16));
  const wave_float t_min = wave_to_float(wave_load_short(node + 32)),
                   t_max = wave_to_float(wave_load_short(node + 48));
  const wave_float d_s = max(max(s_min - half_vectors.s_high, half_vectors.s_low - s_max), 0.0f);
  const wave_float d_t = max(max(t_min - half_vectors.t_high, half_vectors.t_low - t_max), 0.0f);
  // Twice the variance of a piece that is not cut as finely as it should be.
  const float k = query->map.inverse_roughness / MICA_BOUND_ONE;
  const wave_float piece = (k / MOST_CUTS) * max(s_max - s_min, t_max - t_min);
  const wave_float variance =
      1.0f + max(piece * piece, PIECE_ROUGHNESSES * PIECE_ROUGHNESSES) * (1.0f / 9.0f);
  const wave_float x = wave_to_float(i + (WAVE_LANE & 3) * child_size) - query->map.mean_x;
  const wave_float y = wave_to_float(j + (WAVE_LANE >> 2) * child_size) - query->map.mean_y;
  const wave_float q_position = footprint_bound(&query->map, x, y, (float)child_size);
  return wave_ballot(
      wave_mask(k * k * fma(d_s, d_s, d_t * d_t) <= (query->map.cutoff - q_position) * variance) &
          wave_mask(s_min <= s_max),
      scratch);
}

// Sixteen triangles: from the right angle, whose position is (x, y) less the footprint's mean, along both
// legs, which lead to +x, +y or, `turn` being -1, to -x, -y. Normals in roughnesses.
typedef struct {
  wave_float x, y;
  float turn;
  wave_float s, t, s1, t1, s2, t2;
} texel_triangles;

static inline void splat_triangles(global const mica_pyramid_query* query,
                                   private const texel_triangles* triangles, int cuts, wave_int valid,
                                   private const splat_target* target, WAVE_SHARED int* scratch) {
  const texel_triangles tr = *triangles;
  const float size = 1.0f / cuts;
  // P, and P + F with its inverse A.
  const float p_xx = size * size / 18.0f, p_xy = -0.5f * p_xx;
  const float f_xx = p_xx + query->cov_xx, f_xy = p_xy + query->cov_xy, f_yy = p_xx + query->cov_yy;
  const float over_det = 1.0f / fma(f_xx, f_yy, -(f_xy * f_xy));
  const float a_xx = f_yy * over_det, a_xy = -f_xy * over_det, a_yy = f_xx * over_det;
  // P A, and Q
  const float r_xx = fma(p_xx, a_xx, p_xy * a_xy), r_xy = fma(p_xx, a_xy, p_xy * a_yy);
  const float r_yx = fma(p_xy, a_xx, p_xx * a_xy), r_yy = fma(p_xy, a_xy, p_xx * a_yy);
  const float q_xx = p_xx - fma(r_xx, p_xx, r_xy * p_xy), q_xy = p_xy - fma(r_xx, p_xy, r_xy * p_xx);
  const float q_yy = p_xx - fma(r_yx, p_xy, r_yy * p_xx);
  element_lobes lobes;
  lobes.n_ss = fma(tr.s1, fma(q_xx, tr.s1, 2.0f * q_xy * tr.s2), fma(q_yy * tr.s2, tr.s2, 1.0f));
  lobes.n_tt = fma(tr.t1, fma(q_xx, tr.t1, 2.0f * q_xy * tr.t2), fma(q_yy * tr.t2, tr.t2, 1.0f));
  lobes.n_st = fma(tr.s1, fma(q_xx, tr.t1, q_xy * tr.t2), tr.s2 * fma(q_xy, tr.t1, q_yy * tr.t2));
  lobes.root = wave_rough_rsqrt(fma(lobes.n_ss, lobes.n_tt, -(lobes.n_st * lobes.n_st)));
  const wave_float nothing = 0.0f;
  lobes.weight = wave_select(nothing, 0.5f * size * size * sqrt(over_det) * lobes.root, valid);
  for (int row = 0; row < cuts; ++row) {
    for (int piece = 0; piece < 2 * (cuts - row) - 1; ++piece) {
      const float third = (1 + (piece & 1)) * (1.0f / 3.0f);
      const float f = ((piece >> 1) + third) * size, g = (row + third) * size;
      const wave_float x = fma(tr.turn, f, tr.x), y = fma(tr.turn, g, tr.y);
      lobes.q_position = fma(x, fma(a_xx, x, 2.0f * a_xy * y), a_yy * y * y);
      const wave_float along = f - tr.turn * fma(r_xx, x, r_xy * y),
                       up = g - tr.turn * fma(r_yx, x, r_yy * y);
      lobes.r_s = -fma(tr.s1, along, fma(tr.s2, up, tr.s)),
      lobes.r_t = -fma(tr.t1, along, fma(tr.t2, up, tr.t));
      splat(*target, &lobes, 1.0f / query->map.inverse_roughness, query->map.cutoff, query->map.scale,
            scratch);
    }
  }
}

static inline wave_float largest_change(wave_float a, wave_float b) {
  return max(max(fabs(a), fabs(b)), fabs(a - b));
}

// The sixteen quads of a leaf, whose lower left texel is stored at `at` and lies (i, j) texels from the mean.
static inline void take_texels(global const mica_pyramid_query* query, global const int* normals, int at,
                               int i, int j, int room_i, int room_j, private const splat_target* target,
                               WAVE_SHARED int* scratch) {
  quad_corners c;
  load_corners(normals, at, &c);
  const float scale = query->map.inverse_roughness / MICA_NORMAL_ONE;
  const wave_int column = WAVE_LANE & 3, row = WAVE_LANE >> 2;
  const wave_int valid = wave_mask(column < room_i) & wave_mask(row < room_j);
  texel_triangles lower, upper;
  lower.x = wave_to_float(i + column) - query->map.mean_x,
  lower.y = wave_to_float(j + row) - query->map.mean_y;
  upper.x = lower.x + 1.0f, upper.y = lower.y + 1.0f;
  lower.turn = 1.0f, upper.turn = -1.0f;
  lower.s = scale * wave_to_float(c.s00), lower.t = scale * wave_to_float(c.t00);
  upper.s = scale * wave_to_float(c.s11), upper.t = scale * wave_to_float(c.t11);
  lower.s1 = scale * wave_to_float(c.s10 - c.s00), lower.t1 = scale * wave_to_float(c.t10 - c.t00);
  lower.s2 = scale * wave_to_float(c.s01 - c.s00), lower.t2 = scale * wave_to_float(c.t01 - c.t00);
  upper.s1 = scale * wave_to_float(c.s01 - c.s11), upper.t1 = scale * wave_to_float(c.t01 - c.t11);
  upper.s2 = scale * wave_to_float(c.s10 - c.s11), upper.t2 = scale * wave_to_float(c.t10 - c.t11);
  const wave_float change = max(max(largest_change(lower.s1, lower.s2), largest_change(lower.t1, lower.t2)),
                                max(largest_change(upper.s1, upper.s2), largest_change(upper.t1, upper.t2)));
  const int cuts = 1 + min((int)(wave_max(change, scratch) * (1.0f / PIECE_ROUGHNESSES)), MOST_CUTS - 1);
  splat_triangles(query, &lower, cuts, valid, target, scratch);
  splat_triangles(query, &upper, cuts, valid, target, scratch);
}

// What the walk hands down: where to, and of which half vectors.
typedef struct {
  splat_target target;
  half_vector_box half_vectors;
} leaf_results;
#define LEAF_QUERY mica_pyramid_query
#define LEAF_PLACE(query) (&(query)->map)
#define LEAF_NODE_STRIDE MICA_NODE_STRIDE
#define LEAF_SURVIVORS(query, node, i, j, child_size, scratch) \
  surviving_texels(query, results->half_vectors, node, i, j, child_size, scratch)
#define LEAF_TAKE(query, normals, at, i, j, room_i, room_j, results, scratch) \
  take_texels(query, normals, at, i, j, room_i, room_j, &(results)->target, scratch)
#include "map/walk_leaves.h"

// Images of the queries' footprints. Global size: bands of all images (vectors), or 16 a band (items).
WAVE_KERNEL void texel_images(global const mica_pyramid_query* restrict queries, int band_count,
                              mica_image_window window, mica_map_grid grid,
                              global const int* restrict normals, global const short* restrict block_nodes,
                              global const short* restrict tile_nodes, global float* restrict images) {
  WAVE_DECLARE_SCRATCH(scratch);
  WAVE_SHARED float lobe_records[SPLAT_RECORDS];
  if (WAVE_ITEM_INDEX >= band_count) return;
  leaf_results results;
  results.target = band_of(images, window, WAVE_ITEM_INDEX, lobe_records);
  results.half_vectors = half_vectors_of(results.target);
  clear_band(results.target);
  walk_leaves(queries + image_of_band(window, WAVE_ITEM_INDEX), grid, normals, block_nodes, tile_nodes,
              &results, scratch);
}
