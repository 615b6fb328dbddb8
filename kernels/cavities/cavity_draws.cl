// Directions into which a footprint's V-shaped cavities send the light of a view: Algorithm 1 of [Che19], for
// the seed that the host chose by its weight. One query a work-item (vectors) or sixteen (items), of which
// the first one works.

#include "cavities/cavity_seeds.h"
#include "wave/random_numbers.h"

// What light does that one bounce does not let go: 0: it leaves in all directions; 1: it leaves about the
// mirror image in g.
#ifndef MICA_COMPENSATION
#define MICA_COMPENSATION 0
#endif

// Uniforms of a draw, by their dimension; what the lobe of the compensation refuses goes on from there.
enum { DRAW_RADIUS, DRAW_ANGLE, DRAW_FACET, DRAW_SHADOW, DRAW_COMPENSATION = 4, DRAW_TRIES = 64 };

static inline float draw(global const mica_cavity_query* query, uint dimension) {
  return random_uniform((uint)query->key_low, (uint)query->key_high, dimension);
}

// Two normal numbers.
static inline float2 draw_normal(global const mica_cavity_query* query, uint dimension) {
  const float radius = sqrt(-2.0f * log(1.0f - draw(query, dimension)));
  const float turn = 2.0f * draw(query, dimension + 1);
  return radius * (float2)(cospi(turn), sinpi(turn));
}

// The seed's normal on the disk.
static inline float2 seed_normal(global const mica_cavity_query* query, mica_map_grid grid,
                                 global const int* normals) {
  const int texel_i = query->seed_i / MICA_SEEDS, texel_j = query->seed_j / MICA_SEEDS;
  const int block = texel_j / MICA_BLOCK * grid.blocks_x + texel_i / MICA_BLOCK;
  const int at =
      block * MICA_BLOCK_STRIDE + (texel_j % MICA_BLOCK + 1) * MICA_BLOCK_ROW + texel_i % MICA_BLOCK + 1;
  const int right = MICA_INTERPOLATION == 0 ? 0 : query->seed_i % MICA_SEEDS;
  const int up = MICA_INTERPOLATION == 0 ? 0 : query->seed_j % MICA_SEEDS * MICA_BLOCK_ROW;
  float2 sum = 0.0f;
  for (int corner = 0; corner < 4; ++corner) {
    const int from = at + (corner & 1) * right + (corner >> 1) * up;
    sum += (float2)((float)normals[from], (float)normals[from + MICA_BLOCK_PLANE]);
  }
  return sum * (0.25f / MICA_NORMAL_ONE);
}

// Where one bounce sends the light; z is 0 if it stays inside the surface.
static inline float3 draw_bounce(global const mica_cavity_query* query, float2 seed) {
  const float3 inside = 0.0f, view = (float3)(query->view_x, query->view_y, query->view_z);
  const float2 facet = seed + query->roughness * draw_normal(query, DRAW_RADIUS);
  const float squared_cosine = 1.0f - dot(facet, facet);
  if (!(squared_cosine > 0.0f)) return inside;
  const float cosine = sqrt(squared_cosine);
  const float tilt = dot(facet, view.xy) / cosine;
  const float facet_area = max(view.z + tilt, 0.0f), dual_area = max(view.z - tilt, 0.0f);
  const bool on_facet = draw(query, DRAW_FACET) * (facet_area + dual_area) < facet_area;
  const float3 normal = (float3)(on_facet ? facet : -facet, cosine);
  const float3 light = 2.0f * dot(view, normal) * normal - view;
  const float light_tilt = dot(facet, light.xy) / cosine;
  const float opening = max(2.0f * light.z, light.z + fabs(light_tilt));
  if (!(light.z > 0.0f && draw(query, DRAW_SHADOW) * opening < 2.0f * light.z)) return inside;
  return light;
}

static inline float3 draw_compensation(global const mica_cavity_query* query) {
#if MICA_COMPENSATION == 0
  const float squared_radius = draw(query, DRAW_COMPENSATION),
              turn = 2.0f * draw(query, DRAW_COMPENSATION + 1);
  const float radius = sqrt(squared_radius);
  return (float3)(radius * cospi(turn), radius * sinpi(turn), sqrt(1.0f - squared_radius));
#else
  const float2 mirrored = -(float2)(query->view_x, query->view_y);
  for (uint attempt = 0; attempt < DRAW_TRIES; ++attempt) {  // at least one in two is on the disk
    const float2 light = mirrored + query->lobe_sigma * draw_normal(query, DRAW_COMPENSATION + 2 * attempt);
    const float squared_cosine = 1.0f - dot(light, light);
    if (squared_cosine > 0.0f) return (float3)(light, sqrt(squared_cosine));
  }
  return (float3)(mirrored, query->view_z);
#endif
}

// (x, y, z) of every query's light, in the order of their slots.
WAVE_KERNEL void cavity_draws(global const mica_cavity_query* restrict queries, int query_count,
                              mica_map_grid grid, global const int* restrict normals,
                              global float* restrict directions) {
  if (WAVE_ITEM_INDEX >= query_count) return;
#if MICA_WAVE_ITEMS
  if (WAVE_LANE != 0) return;
#endif
  global const mica_cavity_query* query = queries + WAVE_ITEM_INDEX;
  float3 light = draw_bounce(query, seed_normal(query, grid, normals));
  if (!(light.z > 0.0f)) light = draw_compensation(query);
  vstore3(light, 0, directions + 3 * query->map.slot);
}
