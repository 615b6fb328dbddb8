// Importance sampling of `grid`, after [Kem25] Algorithm 2, with a density that is known everywhere.
//
// The disk is cut into the regions in which a direction has the same 2x2 angular cells: squares as wide as a
// cell, shifted by half a cell and cut where the unit square ends. A draw takes a level by its weight, the
// region of a random point of the square, one of its sixteen glints by what its lobe has there (a reservoir),
// and a direction from that lobe, cut to the region. Regions do not overlap, so the density at a direction
// needs its own sixteen glints on both levels and nothing else.
// An eighth of all draws is uniform on the disk: the expectation of glints further away is never left out.
// A lobe is as wide here as at its glint; what that differs from Eq. 4 is in the weights.

#include "glint_level.h"
#include "random_numbers.h"

#define UNIFORM_SHARE 0.125f
#define FLAT_LOBE 0.005f  // widths of a region over that of a lobe, below which the lobe is flat there
#define LEAST_MASS 1e-5f  // a region with less of its glints' lobes has none: their share would be all rounding
#define DIMENSION_CHOICE 0
#define DIMENSION_LEVEL 1
#define DIMENSION_DISK 2    // and the next
#define DIMENSION_LOBE 4    // and the next
#define DIMENSION_GLINTS 6  // one word, of which those of the sixteen glints are a hash

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
  return wave_select(max(share_between(low, high, inverse_sigma), 0.0f), flat, wave_mask(inverse_sigma < FLAT_LOBE));
}

// A glint of a region. Angles are relative to the direction that the level was placed by.
typedef struct {
  wave_float a, b, inverse_a, inverse_b;
  wave_float strength;  // of its lobe: whether it is there, and its place in the footprint
} region_glint;

static inline region_glint glint_of_region(private const glint_level* g, glint_lobe_shape shape, int angular, int cell,
                                           wave_uint angular_key) {
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
  wave_float strength = gaussian_exp2(max(power, LEAST_POWER)) * roulette(GLINT_HIGH(bits.roulette, 0.0f), g->weight);
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
      const wave_float p1 = EXP2_SCALE * glint.a * glint.inverse_a, p2 = EXP2_SCALE * glint.b * glint.inverse_b;
      const wave_float lobe = gaussian_exp2(max(fma(-p1, p1, -p2 * p2), LEAST_POWER));
      mass += mass_in(region, glint);
      density += INVERSE_TWO_PI * glint.strength * glint.inverse_a * glint.inverse_b * lobe;
    }
  }
  const wave_float one = 1.0f, area = (region.high_a - region.low_a) * (region.high_b - region.low_b);
  return wave_select(area * density / max(mass, LEAST_MASS), one, wave_mask(mass <= LEAST_MASS));
}

static inline glint_lobe_shape load_shape(global const int* fields, int pitch, int first) {
  glint_lobe_shape shape;
  shape.alpha_x = 1.0f / GLINT_FLOAT(MICA_GLINT_INVERSE_ALPHA_X);
  shape.alpha_y = 1.0f / GLINT_FLOAT(MICA_GLINT_INVERSE_ALPHA_Y);
  shape.micro_a = GLINT_FLOAT(MICA_GLINT_MICRO_S), shape.micro_b = GLINT_FLOAT(MICA_GLINT_MICRO_T);
  return shape;
}

// Density of `grid_draw` at half vectors, over the disk (s, t).
kernel void grid_draw_density(global const int* restrict fields, int pitch, global float* restrict density) {
  const int first = WAVE_LANES * WAVE_ITEM_INDEX;
  const glint_disk_point direction =
      glint_to_disk(GLINT_FLOAT(MICA_GLINT_HALF_S), GLINT_FLOAT(MICA_GLINT_HALF_T),
                    GLINT_FLOAT(MICA_GLINT_INVERSE_ALPHA_X), GLINT_FLOAT(MICA_GLINT_INVERSE_ALPHA_Y));
  const glint_lobe_shape shape = load_shape(fields, pitch, first);
  const wave_float one = 1.0f;
  glint_level g;
  glint_place p = load_footprint(fields, pitch, first, &g);
  wave_float sum = UNIFORM_SHARE / GLINT_DISK_AREA;
  for (int n = 0; n < 2; ++n) {
    place_footprint(&g, p.i, p.j, p.x, p.y, p.level, p.seed);
    place_angle(&g, direction, one, one, p.level);
    sum += (1.0f - UNIFORM_SHARE) * g.weight * region_density(&g, shape);
    next_level(&p, &g);
  }
  wave_store_float(GLINT_DISK_AREA * direction.density * sum, density + first);
}

// x in [low, high] with the density of a lobe at 0, cut to it: by halving, on the same integral as its share.
static inline wave_float draw_from_lobe(wave_float random, wave_float low, wave_float high, wave_float inverse_sigma) {
  const wave_float reach = 5.4f * wave_reciprocal(inverse_sigma);
  wave_float from = min(max(low, -reach), high), to = max(min(high, reach), low);
  const wave_float flat = fma(random, high - low, low);
  const wave_float below = gaussian_cdf_centred(CDF_SCALE * from * inverse_sigma);
  const wave_float all = gaussian_cdf_centred(CDF_SCALE * to * inverse_sigma) - below;
  for (int step = 0; step < 24; ++step) {
    const wave_float middle = 0.5f * (from + to);
    const wave_int is_below =
        wave_mask(gaussian_cdf_centred(CDF_SCALE * middle * inverse_sigma) - below < random * all);
    from = wave_select(from, middle, is_below), to = wave_select(middle, to, is_below);
  }
  return wave_select(0.5f * (from + to), flat, wave_mask(inverse_sigma < FLAT_LOBE));
}

// Draws half vectors (s, t), two rows of `pitch`. Fields as of a query, with the key of the draw's random
// numbers where a query has its half vector. A draw that leaves the disk is (2, 2).
kernel void grid_draw(global const int* restrict fields, int pitch, global float* restrict half_vectors) {
  const int first = WAVE_LANES * WAVE_ITEM_INDEX;
  const wave_uint key_low = wave_to_uint(GLINT_INT(MICA_GLINT_HALF_S)),
                  key_high = wave_to_uint(GLINT_INT(MICA_GLINT_HALF_T));
#define RANDOM(dimension) wave_random_uniform(key_low, key_high, (wave_uint)(uint)(dimension))
  const glint_lobe_shape shape = load_shape(fields, pitch, first);
  const wave_float one = 1.0f, outside = 2.0f;
  glint_level g;
  glint_place p = load_footprint(fields, pitch, first, &g);
  glint_disk_point square;  // the region is where this lies
  square.x = RANDOM(DIMENSION_DISK), square.y = RANDOM(DIMENSION_DISK + 1), square.density = one;
  const wave_float turn = 6.28318531f * square.y, radius = 0.5f * sqrt(square.x);
  wave_float x = fma(radius, cos(turn), 0.5f), y = fma(radius, sin(turn), 0.5f);  // of a uniform draw
  const wave_int is_uniform = wave_mask(RANDOM(DIMENSION_CHOICE) < UNIFORM_SHARE);
  const wave_float level_choice = RANDOM(DIMENSION_LEVEL);
  const wave_uint glints_word = wave_random_bits(key_low, key_high, (wave_uint)(uint)DIMENSION_GLINTS);
  wave_float below = 0.0f;  // weight of the levels before this one
  for (int n = 0; n < 2; ++n) {
    place_footprint(&g, p.i, p.j, p.x, p.y, p.level, p.seed);
    place_angle(&g, square, one, one, p.level);
    const glint_region region = region_of(&g);
    region_glint kept;
    kept.a = 0.0f, kept.b = 0.0f, kept.inverse_a = 0.0f, kept.inverse_b = 0.0f;  // flat: where there is no glint
    wave_float mass = 0.0f;
    for (int angular = 0; angular < 4; ++angular) {
      const wave_uint key = glint_angular_key(wave_to_uint(g.k + (angular & 1)), wave_to_uint(g.l + (angular >> 1)));
      for (int cell = 0; cell < 4; ++cell) {
        const region_glint glint = glint_of_region(&g, shape, angular, cell, key);
        const wave_float part = mass_in(region, glint);
        mass += part;
        const wave_uint word = glint_mix(glints_word + (uint)(16 * n + 4 * angular + cell) * 0x9e3779b9u);
        const wave_float chance = wave_uint_to_float(word >> 8) * (1.0f / 16777216);
        const wave_int takes = wave_mask(chance * mass < part);
        kept.a = wave_select(kept.a, glint.a, takes), kept.b = wave_select(kept.b, glint.b, takes);
        kept.inverse_a = wave_select(kept.inverse_a, glint.inverse_a, takes);
        kept.inverse_b = wave_select(kept.inverse_b, glint.inverse_b, takes);
      }
    }
    const wave_int empty = wave_mask(mass <= LEAST_MASS);
    const wave_float none = 0.0f;
    kept.inverse_a = wave_select(kept.inverse_a, none, empty);
    kept.inverse_b = wave_select(kept.inverse_b, none, empty);
    const wave_float a = kept.a + draw_from_lobe(RANDOM(DIMENSION_LOBE), region.low_a - kept.a,
                                                 region.high_a - kept.a, kept.inverse_a);
    const wave_float b = kept.b + draw_from_lobe(RANDOM(DIMENSION_LOBE + 1), region.low_b - kept.b,
                                                 region.high_b - kept.b, kept.inverse_b);
    const wave_float cell = wave_reciprocal(g.cells);
    const wave_int here = wave_mask(level_choice >= below) & wave_mask(level_choice < below + g.weight) & ~is_uniform;
    x = wave_select(x, fma(a, cell, square.x), here), y = wave_select(y, fma(b, cell, square.y), here);
    below += g.weight;
    next_level(&p, &g);
  }
  const wave_float from_a = x - 0.5f, from_b = y - 0.5f;
  wave_float s, t;
  glint_from_disk(x, y, shape.alpha_x, shape.alpha_y, &s, &t);
  const wave_int inside = wave_mask(fma(from_a, from_a, from_b * from_b) < 0.25f);
  wave_store_float(wave_select(outside, s, inside), half_vectors + first);
  wave_store_float(wave_select(outside, t, inside), half_vectors + pitch + first);
}
