// `grid`: the P-NDF of glints on an implicit grid, in constant time. [Kem25] Algorithm 1.
//
// Glints are points of space x disk: one, at random, in every cell of a 4D grid. A query looks at the 2x2
// spatial and 2x2 angular cells around it on two levels of detail, and takes the expectation of all other
// glints. One lane a query: no lane waits for another.
// MICA_FIRST_ORDER 1: half vectors turn over the footprint, and lobes need not be round.

#include "grid/glint_level.h"

// Densities over the disk of half vectors, MICA_GLINT_COLORS rows of `pitch`. Global size: a lane for each
// query of the padded batch.
WAVE_KERNEL void grid(global const int* restrict fields, int pitch, global float* restrict density) {
  const int first = WAVE_LANES * WAVE_ITEM_INDEX;
  const glint_disk_point direction =
      glint_to_disk(GLINT_FLOAT(MICA_GLINT_HALF_S), GLINT_FLOAT(MICA_GLINT_HALF_T),
                    GLINT_FLOAT(MICA_GLINT_INVERSE_ALPHA_X), GLINT_FLOAT(MICA_GLINT_INVERSE_ALPHA_Y));
  glint_level g;
#if MICA_FIRST_ORDER
  const wave_float sigma_a = GLINT_FLOAT(MICA_GLINT_LOBE_A), sigma_b = GLINT_FLOAT(MICA_GLINT_LOBE_B);
  const wave_float smooth = GLINT_FLOAT(MICA_GLINT_DENSITY);
  g.turn = load_turn(fields, pitch, first);
#else
  const wave_float jacobian = max(GLINT_DISK_AREA * direction.density, 1e-20f);  // |J_T|, Eq. 3
  const wave_float stretch = jacobian * wave_rsqrt(jacobian);
  const wave_float sigma_a = GLINT_FLOAT(MICA_GLINT_MICRO_S) * stretch,
                   sigma_b = GLINT_FLOAT(MICA_GLINT_MICRO_T) * stretch;
  const wave_float smooth = direction.density;
#endif
  glint_place p = load_footprint(fields, pitch, first, &g);
  glint_density sum;
  for (int color = 0; color < MICA_GLINT_COLORS; ++color) sum.of_color[color] = 0.0f;
  for (int n = 0; n < 2; ++n) {
    place_footprint(&g, p.i, p.j, p.x, p.y, p.level, p.seed);
    place_angle(&g, direction, sigma_a, sigma_b, p.level);
    add_level(&g, &sum);
    next_level(&p, &g);
  }
  for (int color = 0; color < MICA_GLINT_COLORS; ++color)
    wave_store_float(smooth * sum.of_color[color], density + color * pitch + first);
}

// T and T^-1 for points given as pairs of rows of `pitch`, for tests. Out: x, y, D, or s, t.
WAVE_KERNEL void grid_to_disk(global const float* restrict half_vectors, int pitch, float alpha_x,
                              float alpha_y, global float* restrict points) {
  const int first = WAVE_LANES * WAVE_ITEM_INDEX;
  const wave_float inverse_x = 1.0f / alpha_x, inverse_y = 1.0f / alpha_y;
  const glint_disk_point point =
      glint_to_disk(wave_load_float(half_vectors + first), wave_load_float(half_vectors + pitch + first),
                    inverse_x, inverse_y);
  wave_store_float(point.x, points + first);
  wave_store_float(point.y, points + pitch + first);
  wave_store_float(point.density, points + 2 * pitch + first);
}

WAVE_KERNEL void grid_from_disk(global const float* restrict points, int pitch, float alpha_x, float alpha_y,
                                global float* restrict half_vectors) {
  const int first = WAVE_LANES * WAVE_ITEM_INDEX;
  wave_float s, t;
  glint_from_disk(wave_load_float(points + first), wave_load_float(points + pitch + first), alpha_x, alpha_y,
                  &s, &t);
  wave_store_float(s, half_vectors + first);
  wave_store_float(t, half_vectors + pitch + first);
}
