// Included by triangles.cl: the leaf of a bicubic map, one texel quad after the other, its 4x4 sub-quads in
// the lanes.
#ifndef MICA_CATMULL_ROM_H
#define MICA_CATMULL_ROM_H

// Weight of control point `k` (-1, 0, 1, 2) at x = 0, 1/4, 1/2, 3/4, 1 of the quad. Catmull-Rom, tension 1/2.
constant float catmull_rom_weights[20] = {0.0f, -9.0f / 128,  -1.0f / 16, -3.0f / 128,  0.0f,   // k = -1
                                          1.0f, 111.0f / 128, 9.0f / 16,  29.0f / 128,  0.0f,   // k = 0
                                          0.0f, 29.0f / 128,  9.0f / 16,  111.0f / 128, 1.0f,   // k = 1
                                          0.0f, -3.0f / 128,  -1.0f / 16, -9.0f / 128,  0.0f};  // k = 2

// Weights of control point k at the lower (side 0) or upper (side 1) edge of the lanes' sub-quads, along x or
// y.
static inline wave_float weight_x(int k, int side) {
#if MICA_WAVE_ITEMS
  return catmull_rom_weights[5 * k + (WAVE_LANE & 3) + side];
#else
  const float4 w = vload4(0, catmull_rom_weights + 5 * k + side);
  return (float16)(w, w, w, w);
#endif
}
static inline wave_float weight_y(int k, int side) {
#if MICA_WAVE_ITEMS
  return catmull_rom_weights[5 * k + (WAVE_LANE >> 2) + side];
#else
  const float4 w = vload4(0, catmull_rom_weights + 5 * k + side);
  return (float16)((float4)(w.x), (float4)(w.y), (float4)(w.z), (float4)(w.w));
#endif
}

// Normal offsets at the corners of the sub-quads, of the component whose quad corner 00 is at `texel`.
static inline void subquad_corners(global const int* texel, int half_vector, float inverse_roughness,
                                   private wave_float* c00, private wave_float* c10, private wave_float* c01,
                                   private wave_float* c11) {
  const float scale = inverse_roughness / MICA_NORMAL_ONE;
  wave_float v00 = 0.0f, v10 = 0.0f, v01 = 0.0f, v11 = 0.0f;
  for (int row = 0; row < 4; ++row) {
    wave_float left = 0.0f, right = 0.0f;
    for (int k = 0; k < 4; ++k) {
      const float value = scale * (float)(texel[(row - 1) * MICA_BLOCK_ROW + k - 1] - half_vector);
      left = fma(weight_x(k, 0), value, left);
      right = fma(weight_x(k, 1), value, right);
    }
    const wave_float below = weight_y(row, 0), above = weight_y(row, 1);
    v00 = fma(below, left, v00), v10 = fma(below, right, v10);
    v01 = fma(above, left, v01), v11 = fma(above, right, v11);
  }
  *c00 = v00, *c10 = v10, *c01 = v01, *c11 = v11;
}

// Distance of the half vector from all values that Catmull-Rom can take between the texels `lanes` and their
// right and upper neighbours: 25/16 is the sum of the absolute weights at the centre, their largest.
static inline wave_float patch_distance(global const int* texel, int half_vector, float inverse_roughness) {
  const wave_int first = wave_load_4x4(texel - MICA_BLOCK_ROW - 1, MICA_BLOCK_ROW) - half_vector;
  wave_int low = first, high = first;
  for (int n = 1; n < 16; ++n) {
    const int offset = ((n >> 2) - 1) * MICA_BLOCK_ROW + (n & 3) - 1;
    const wave_int value = wave_load_4x4(texel + offset, MICA_BLOCK_ROW) - half_vector;
    low = min(low, value), high = max(high, value);
  }
  const wave_float scale = inverse_roughness / MICA_NORMAL_ONE;
  const wave_float a = wave_to_float(low), b = wave_to_float(high);
  return scale * max(fabs(0.5f * (a + b)) - 1.5625f * 0.5f * (b - a), 0.0f);
}

// As its namesake in texel_quads.h.
static inline void take_leaf(global const mica_map_query* query, global const int* normals, int at, int i,
                             int j, int room_i, int room_j, private wave_list* list, private integrator* out,
                             WAVE_SHARED int* scratch) {
  global const int* texel = normals + at;
  const wave_int inside_map = wave_mask((WAVE_LANE & 3) < room_i) & wave_mask((WAVE_LANE >> 2) < room_j);
  const wave_float d_s = patch_distance(texel, query->half_s, query->inverse_roughness);
  const wave_float d_t = patch_distance(texel + MICA_BLOCK_PLANE, query->half_t, query->inverse_roughness);
  const wave_float x = wave_to_float(i + (WAVE_LANE & 3)) - query->mean_x;
  const wave_float y = wave_to_float(j + (WAVE_LANE >> 2)) - query->mean_y;
  const wave_float bound = fma(d_s, d_s, fma(d_t, d_t, footprint_bound(query, x, y, 1.0f)));
  uint patches = wave_ballot(wave_mask(bound <= query->cutoff) & inside_map, scratch);
  for (; patches; patches &= patches - 1) {
    const int patch = lowest_bit(patches), patch_i = patch & 3, patch_j = patch >> 2;
    global const int* corner = texel + patch_j * MICA_BLOCK_ROW + patch_i;
    quads q;
    q.x = fma(0.25f, wave_to_float(WAVE_LANE & 3), (float)(i + patch_i) - query->mean_x);
    q.y = fma(0.25f, wave_to_float(WAVE_LANE >> 2), (float)(j + patch_j) - query->mean_y);
    subquad_corners(corner, query->half_s, query->inverse_roughness, &q.s00, &q.s10, &q.s01, &q.s11);
    subquad_corners(corner + MICA_BLOCK_PLANE, query->half_t, query->inverse_roughness, &q.t00, &q.t10,
                    &q.t01, &q.t11);
    const wave_float b_s =
        max(max(min(min(q.s00, q.s10), min(q.s01, q.s11)), -max(max(q.s00, q.s10), max(q.s01, q.s11))), 0.0f);
    const wave_float b_t =
        max(max(min(min(q.t00, q.t10), min(q.t01, q.t11)), -max(max(q.t00, q.t10), max(q.t01, q.t11))), 0.0f);
    const wave_float box = fma(b_s, b_s, fma(b_t, b_t, footprint_bound(query, q.x, q.y, QUAD_SIZE)));
    const uint bits = wave_ballot(wave_mask(box <= query->cutoff), scratch);
    if (bits) take_quads(query, &q, bits, list, out, scratch);
  }
}

#endif  // MICA_CATMULL_ROM_H
