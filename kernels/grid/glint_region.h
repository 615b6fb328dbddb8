// The regions into which draws of `grid` cut the disk, and the lobes of their glints. See grid_brdf.cl.
#ifndef MICA_GLINT_REGION_H
#define MICA_GLINT_REGION_H

#include "grid/glint_level.h"

#define FLAT_LOBE 0.005f  // widths of a region over that of a lobe, below which the lobe is flat there
#define LEAST_MASS \
  1e-5f  // a region with less of its glints' lobes has none: their share would be all rounding

// Roughness of the smooth distribution and of a single glint's lobe on the disk of half vectors.
typedef struct {
  wave_float alpha_x, alpha_y, micro_a, micro_b;
} glint_lobe_shape;

// sqrt(|J_T|), Eq. 3, at a point of the disk; (u, v) relative to its centre, in radii.
static inline wave_float root_jacobian(wave_float u, wave_float v, glint_lobe_shape shape) {
  const wave_float radius2 = min(fma(u, u, v * v), 0.9999999f);
  const wave_float a = shape.alpha_x * u, b = shape.alpha_y * v, z2 = 1.0f - radius2;
  const wave_float slope2 = fma(a, a, b * b);
#if MICA_DISTRIBUTION == 0
  const wave_float stretch2 =
      wave_select(-log(z2) / max(radius2, 1e-30f), 1.0f + 0.5f * radius2, wave_mask(radius2 < 1e-3f));
  const wave_float root = sqrt(z2) * fma(slope2, stretch2, 1.0f);
#else
  const wave_float root = slope2 + z2;
#endif
  return 0.5f * root * rsqrt(shape.alpha_x * shape.alpha_y);
}

// Integral of a lobe over [low, high], relative to its centre.
static inline wave_float lobe_share(wave_float low, wave_float high, wave_float inverse_sigma) {
  const wave_float flat = 0.398942280f * (high - low) * inverse_sigma;
  return wave_select(max(share_between(low, high, inverse_sigma), 0.0f), flat,
                     wave_mask(inverse_sigma < FLAT_LOBE));
}

// A glint of a region. Angles are relative to the direction that the level was placed by.
typedef struct {
  wave_float a, b, inverse_a, inverse_b;
  wave_float strength;  // strength of its lobe: whether it is there, and its place in the footprint
} region_glint;

static inline region_glint glint_of_region(private const glint_level* g, glint_lobe_shape shape, int angular,
                                           int cell, wave_uint angular_key) {
  const int dk = angular & 1, dl = angular >> 1, di = cell & 1, dj = cell >> 1;
  const glint_bits bits = glint_draw(g->spatial_keys[cell], angular_key);
  const wave_float x = GLINT_LOW(bits.place, (float)di - g->x), y = GLINT_HIGH(bits.place, (float)dj - g->y);
  region_glint glint;
  glint.a = GLINT_LOW(bits.angle, (float)dk - g->a), glint.b = GLINT_HIGH(bits.angle, (float)dl - g->b);
  const wave_float p1 = EXP2_SCALE * fma(g->w1x, x, g->w1y * y), p2 = EXP2_SCALE * fma(g->w2x, x, g->w2y * y);
  const wave_float power = fma(-p1, p1, -p2 * p2);
  const wave_float inverse_radius = 2.0f * wave_reciprocal(g->cells);
  const wave_float u = (glint.a + g->center_a) * inverse_radius, v = (glint.b + g->center_b) * inverse_radius;
  const wave_int counts = wave_mask(fma(u, u, v * v) < 1.0f) & wave_mask(power > LEAST_POWER);
  wave_float strength =
      gaussian_exp2(max(power, LEAST_POWER)) * roulette(GLINT_HIGH(bits.roulette, 0.0f), g->weight);
#if MICA_GLINT_ROULETTE
  strength *= presence_of(GLINT_HIGH(glint_draw_more(bits), 0.0f), g->presence, g->inverse_width);
#endif
  const wave_float zero = 0.0f, width = root_jacobian(u, v, shape) * g->cells;
  glint.strength = wave_select(zero, strength, counts);
  glint.inverse_a = wave_reciprocal(max(shape.micro_a * width, 1e-6f));
  glint.inverse_b = wave_reciprocal(max(shape.micro_b * width, 1e-6f));
  return glint;
}

// The region of the direction that a level was placed by, relative to it. Its area is its chance, times the
// number of cells.
typedef struct {
  wave_float low_a, high_a, low_b, high_b;
} glint_region;

static inline glint_region region_of(private const glint_level* g) {
  const wave_float half_square = 0.5f * g->cells;
  glint_region region;
  region.low_a = max(0.5f - g->a, -half_square - g->center_a);
  region.high_a = min(1.5f - g->a, half_square - g->center_a);
  region.low_b = max(0.5f - g->b, -half_square - g->center_b);
  region.high_b = min(1.5f - g->b, half_square - g->center_b);
  return region;
}

// What the lobe has in the region.
static inline wave_float mass_in(glint_region region, region_glint glint) {
  return glint.strength * lobe_share(region.low_a - glint.a, region.high_a - glint.a, glint.inverse_a) *
         lobe_share(region.low_b - glint.b, region.high_b - glint.b, glint.inverse_b);
}

// Density of draws on this level at the direction that it was placed by, per area of the square: uniform in a
// region where there are no glints.
static inline wave_float region_density(private const glint_level* g, glint_lobe_shape shape) {
  const glint_region region = region_of(g);
  wave_float mass = 0.0f, density = 0.0f;
  for (int angular = 0; angular < 4; ++angular) {
    const wave_uint key =
        glint_angular_key(wave_to_uint(g->k + (angular & 1)), wave_to_uint(g->l + (angular >> 1)));
    for (int cell = 0; cell < 4; ++cell) {
      const region_glint glint = glint_of_region(g, shape, angular, cell, key);
      const wave_float p1 = EXP2_SCALE * glint.a * glint.inverse_a,
                       p2 = EXP2_SCALE * glint.b * glint.inverse_b;
      const wave_float lobe = gaussian_exp2(max(fma(-p1, p1, -p2 * p2), LEAST_POWER));
      mass += mass_in(region, glint);
      density += INVERSE_TWO_PI * glint.strength * glint.inverse_a * glint.inverse_b * lobe;
    }
  }
  const wave_float one = 1.0f, area = (region.high_a - region.low_a) * (region.high_b - region.low_b);
  return wave_select(area * density / max(mass, LEAST_MASS), one, wave_mask(mass <= LEAST_MASS));
}

#endif  // MICA_GLINT_REGION_H
