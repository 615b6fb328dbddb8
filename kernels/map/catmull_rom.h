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
static inline void subquad_corners(global const int* texel, int half_vector, float scale,
                                   private wave_float* c00, private wave_float* c10, private wave_float* c01,
                                   private wave_float* c11) {
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

// The interval of all values that Catmull-Rom can take between the texels `lanes` and their right and upper
// neighbours, less the half vector: 25/16 is the sum of the absolute weights at the centre, their largest.
static inline void patch_interval(global const int* texel, int half_vector, private wave_float* middle,
                                  private wave_float* half_width) {
  const wave_int first = wave_load_4x4(texel - MICA_BLOCK_ROW - 1, MICA_BLOCK_ROW) - half_vector;
  wave_int low = first, high = first;
  for (int n = 1; n < 16; ++n) {
    const int offset = ((n >> 2) - 1) * MICA_BLOCK_ROW + (n & 3) - 1;
    const wave_int value = wave_load_4x4(texel + offset, MICA_BLOCK_ROW) - half_vector;
    low = min(low, value), high = max(high, value);
  }
  const wave_float a = wave_to_float(low), b = wave_to_float(high);
  *middle = 0.5f * (a + b), *half_width = 1.5625f * 0.5f * (b - a);
}

// Lower bound of the squared length of the whitened residual in the lanes' quads.
static inline wave_float patch_bound(global const triangle_query* query, global const int* texel,
                                     wave_float x, wave_float y, float scale) {
  global const mica_map_query* place = PLACE(query);
  wave_float s, t, half_s, half_t;
  patch_interval(texel, place->half_s, &s, &half_s);
  patch_interval(texel + MICA_BLOCK_PLANE, place->half_t, &t, &half_t);
  const wave_float rest = footprint_bound(place, x, y, 1.0f);
#if MICA_FIRST_ORDER
  return rest + lobe_bound(&query->lobe, scale * s, scale * t, scale * half_s, scale * half_t, x, y, 1.0f);
#else
  const wave_float d_s = scale * max(fabs(s) - half_s, 0.0f), d_t = scale * max(fabs(t) - half_t, 0.0f);
  return fma(d_s, d_s, fma(d_t, d_t, rest));
#endif
}

// As its namesake in texel_quads.h.
static inline void take_leaf(global const triangle_query* query, global const int* normals, int at, int i,
                             int j, int room_i, int room_j, private waiting_quads* waiting,
                             private integrator* out, WAVE_SHARED int* scratch) {
  global const mica_map_query* place = PLACE(query);
#if MICA_FIRST_ORDER
  const float scale = 1.0f / MICA_NORMAL_ONE;
#else
  const float scale = place->inverse_roughness / MICA_NORMAL_ONE;
#endif
  global const int* texel = normals + at;
  const wave_int inside_map = wave_mask((WAVE_LANE & 3) < room_i) & wave_mask((WAVE_LANE >> 2) < room_j);
  const wave_float x = wave_to_float(i + (WAVE_LANE & 3)) - place->mean_x;
  const wave_float y = wave_to_float(j + (WAVE_LANE >> 2)) - place->mean_y;
  const wave_float bound = patch_bound(query, texel, x, y, scale);
  uint patches = wave_ballot(wave_mask(bound <= place->cutoff) & inside_map, scratch);
  for (; patches; patches &= patches - 1) {
    const int patch = lowest_bit(patches), patch_i = patch & 3, patch_j = patch >> 2;
    global const int* corner = texel + patch_j * MICA_BLOCK_ROW + patch_i;
    quads q;
    q.x = fma(0.25f, wave_to_float(WAVE_LANE & 3), (float)(i + patch_i) - place->mean_x);
    q.y = fma(0.25f, wave_to_float(WAVE_LANE >> 2), (float)(j + patch_j) - place->mean_y);
    subquad_corners(corner, place->half_s, scale, &q.s00, &q.s10, &q.s01, &q.s11);
    subquad_corners(corner + MICA_BLOCK_PLANE, place->half_t, scale, &q.t00, &q.t10, &q.t01, &q.t11);
#if MICA_FIRST_ORDER
    whiten_quads(query, &q);
#endif
    const wave_float box = quads_bound(place, &q);
    const uint bits = wave_ballot(wave_mask(box <= place->cutoff), scratch);
    if (bits) take_quads(place, &q, bits, waiting, out, scratch);
  }
}

#endif  // MICA_CATMULL_ROM_H
