// Culling on the implicit grid of a normal map: which of a node's sixteen children can matter to a query.
// [Yan14] sec. 6, with one cutoff on the sum of both Gaussians' exponents in place of five sigma for each.
#ifndef MICA_MAP_CULL_H
#define MICA_MAP_CULL_H

#include "types.h"
#include "wave/wave.h"

// Lower bound of |W (u - mean)|^2 over squares whose lower left corner lies (x, y) texels from the mean.
static inline wave_float footprint_bound(global const mica_map_query* query, wave_float x, wave_float y,
                                         float size) {
  const wave_float center_x = x + 0.5f * size, center_y = y + 0.5f * size;
  const wave_float r1 = 0.5f * size * (fabs(query->whiten_1x) + fabs(query->whiten_1y));
  const wave_float r2 = 0.5f * size * (fabs(query->whiten_2x) + fabs(query->whiten_2y));
  const wave_float d1 = max(fabs(fma(query->whiten_1x, center_x, query->whiten_1y * center_y)) - r1, 0.0f);
  const wave_float d2 = max(fabs(fma(query->whiten_2x, center_x, query->whiten_2y * center_y)) - r2, 0.0f);
  return fma(d1, d1, d2 * d2);
}

// Bits of the children of `node` that reach the cutoff. The node's lower left corner is (i, j) texels from
// the footprint's whole-texel mean.
static inline uint surviving_children(global const mica_map_query* query, global const short* node, int i,
                                      int j, int child_size, WAVE_SHARED int* scratch) {
  const wave_float s_min = wave_to_float(wave_load_short(node));
  const wave_float s_max = wave_to_float(wave_load_short(node + 16));
  const wave_float t_min = wave_to_float(wave_load_short(node + 32));
  const wave_float t_max = wave_to_float(wave_load_short(node + 48));
  const float to_bound = (float)MICA_BOUND_ONE / MICA_NORMAL_ONE;
  const float h_s = query->half_s * to_bound, h_t = query->half_t * to_bound;
  const wave_float d_s = max(max(s_min - h_s, h_s - s_max), 0.0f);
  const wave_float d_t = max(max(t_min - h_t, h_t - t_max), 0.0f);
  const float k = query->inverse_roughness / MICA_BOUND_ONE;
  const wave_float q_normal = k * k * fma(d_s, d_s, d_t * d_t);
  const wave_float x = wave_to_float(i + (WAVE_LANE & 3) * child_size) - query->mean_x;
  const wave_float y = wave_to_float(j + (WAVE_LANE >> 2) * child_size) - query->mean_y;
  const wave_float q = q_normal + footprint_bound(query, x, y, (float)child_size);
  return wave_ballot(wave_mask(q <= query->cutoff) & wave_mask(s_min <= s_max), scratch);
}

// (i, j) of the texel at which a block of the unrolled plane begins, relative to the footprint's mean, and
// its index in storage. Blocks are counted from the map's origin; periods repeat every blocks_x and blocks_y
// of them.
typedef struct {
  int i, j, index;
} map_block;

static inline int floor_divide(int a, int b) {
  return a / b - (a % b < 0);
}

static inline map_block locate_block(mica_map_grid grid, global const mica_map_query* query, int block_x,
                                     int block_y) {
  const int period_x = floor_divide(block_x, grid.blocks_x), period_y = floor_divide(block_y, grid.blocks_y);
  const int inside_x = block_x - period_x * grid.blocks_x, inside_y = block_y - period_y * grid.blocks_y;
  map_block block;
  block.i = period_x * grid.width + inside_x * MICA_BLOCK - query->mean_i;
  block.j = period_y * grid.height + inside_y * MICA_BLOCK - query->mean_j;
  block.index = inside_y * grid.blocks_x + inside_x;
  return block;
}

// Block that holds texel `i` of the unrolled plane.
static inline int block_of(int i, int size, int blocks) {
  const int period = floor_divide(i, size);
  return period * blocks + (i - period * size) / MICA_BLOCK;
}

// First and last of the blocks [first_x, last_x] in row `block_y` that the footprint can reach: a long one
// that lies obliquely passes by most of the blocks around it. Of |W (x, y)|^2 <= cutoff at height y there
// remains |x + q / p y| <= sqrt(cutoff / p), where W'W = (p q; q r).
static inline int2 blocks_in_reach(global const mica_map_query* query, mica_map_grid grid, int block_y,
                                   int first_x, int last_x) {
  const int period_y = floor_divide(block_y, grid.blocks_y),
            inside_y = (block_y - period_y * grid.blocks_y) * MICA_BLOCK;
  const float bottom = (float)(period_y * grid.height + inside_y - query->mean_j) - query->mean_y;
  const float top = bottom + (float)min(MICA_BLOCK, grid.height - inside_y);
  const float p = fma(query->whiten_1x, query->whiten_1x, query->whiten_2x * query->whiten_2x);
  const float q = fma(query->whiten_1x, query->whiten_1y, query->whiten_2x * query->whiten_2y);
  const float slope = -q / p, at_bottom = slope * bottom, at_top = slope * top;
  // The slack is for rounding, which grows with the distance.
  const float reach = fma(1e-4f, max(fabs(at_bottom), fabs(at_top)), 1.001f * sqrt(query->cutoff / p) + 1.0f);
  const float left = max(min(at_bottom, at_top) - reach, -query->extent_x),
              right = min(max(at_bottom, at_top) + reach, query->extent_x);
  if (left > right) return (int2)(first_x, first_x - 1);
  const int left_i = query->mean_i + (int)floor(query->mean_x + left),
            right_i = query->mean_i + (int)floor(query->mean_x + right);
  return (int2)(max(first_x, block_of(left_i, grid.width, grid.blocks_x)),
                min(last_x, block_of(right_i, grid.width, grid.blocks_x)));
}

#endif  // MICA_MAP_CULL_H
