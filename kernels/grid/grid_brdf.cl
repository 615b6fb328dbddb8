// Importance sampling of `grid`, after [Kem25] Algorithm 2, with a density that is known everywhere.
//
// The disk is cut into the regions in which a direction has the same 2x2 angular cells: squares as wide as a
// cell, shifted by half a cell and cut where the unit square ends. A draw takes a level by its weight, the
// region of a random point of the square, one of its sixteen glints by what its lobe has there (a reservoir),
// and a direction from that lobe, cut to the region. Regions do not overlap, so the density at a direction
// needs its own sixteen glints on both levels and nothing else.
// An eighth of all draws is uniform on the disk: the expectation of glints further away is never left out.
// A lobe is as wide here as at its glint; what that differs from Eq. 4 is in the weights.

#include "grid/glint_region.h"
#include "wave/random_numbers.h"

#define UNIFORM_SHARE 0.125f
#define DIMENSION_CHOICE 0
#define DIMENSION_LEVEL 1
#define DIMENSION_DISK 2    // and the next
#define DIMENSION_LOBE 4    // and the next
#define DIMENSION_GLINTS 6  // one word, of which those of the sixteen glints are a hash

static inline glint_lobe_shape load_shape(global const int* fields, int pitch, int first) {
  glint_lobe_shape shape;
  shape.alpha_x = 1.0f / GLINT_FLOAT(MICA_GLINT_INVERSE_ALPHA_X);
  shape.alpha_y = 1.0f / GLINT_FLOAT(MICA_GLINT_INVERSE_ALPHA_Y);
  shape.micro_a = GLINT_FLOAT(MICA_GLINT_MICRO_S), shape.micro_b = GLINT_FLOAT(MICA_GLINT_MICRO_T);
  return shape;
}

// Density of `grid_draw` at half vectors, over the disk (s, t).
WAVE_KERNEL void grid_draw_density(global const int* restrict fields, int pitch,
                                   global float* restrict density) {
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
static inline wave_float draw_from_lobe(wave_float random, wave_float low, wave_float high,
                                        wave_float inverse_sigma) {
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

// The coarser of the two levels where `random` is at or above the weight of the finer one.
static inline void choose_level(wave_float random, private glint_place* p, private glint_level* g) {
  const wave_int coarser = wave_mask(random >= g->weight), finer = ~coarser;
  glint_place next = *p;
  const glint_level whole = *g;
  next_level(&next, g);
  p->x = wave_select(p->x, next.x, coarser), p->y = wave_select(p->y, next.y, coarser);
  p->i = (p->i & finer) | (next.i & coarser), p->j = (p->j & finer) | (next.j & coarser);
  p->level = (p->level & finer) | (next.level & coarser);
  g->w1x = wave_select(whole.w1x, g->w1x, coarser), g->w1y = wave_select(whole.w1y, g->w1y, coarser);
  g->w2x = wave_select(whole.w2x, g->w2x, coarser), g->w2y = wave_select(whole.w2y, g->w2y, coarser);
  g->weight = wave_select(whole.weight, g->weight, coarser);
}

// One of the glints of a region, by what it has there; flat where there is none. `word`: random bits, of
// which each glint's are a hash.
static inline region_glint draw_glint(private const glint_level* g, glint_lobe_shape shape,
                                      glint_region region, wave_uint word) {
  region_glint kept;
  kept.a = 0.0f, kept.b = 0.0f, kept.inverse_a = 0.0f, kept.inverse_b = 0.0f, kept.strength = 0.0f;
  wave_float mass = 0.0f;
  for (int angular = 0; angular < 4; ++angular) {
    const wave_uint key =
        glint_angular_key(wave_to_uint(g->k + (angular & 1)), wave_to_uint(g->l + (angular >> 1)));
    for (int cell = 0; cell < 4; ++cell) {
      const region_glint glint = glint_of_region(g, shape, angular, cell, key);
      const wave_float part = mass_in(region, glint);
      mass += part;
      const wave_uint bits = glint_mix(word + (uint)(4 * angular + cell) * 0x9e3779b9u);
      const wave_float chance = wave_uint_to_float(bits >> 8) * (1.0f / 16777216);
      const wave_int takes = wave_mask(chance * mass < part);
      kept.a = wave_select(kept.a, glint.a, takes), kept.b = wave_select(kept.b, glint.b, takes);
      kept.inverse_a = wave_select(kept.inverse_a, glint.inverse_a, takes);
      kept.inverse_b = wave_select(kept.inverse_b, glint.inverse_b, takes);
    }
  }
  const wave_float none = 0.0f;
  const wave_int empty = wave_mask(mass <= LEAST_MASS);
  kept.inverse_a = wave_select(kept.inverse_a, none, empty);
  kept.inverse_b = wave_select(kept.inverse_b, none, empty);
  return kept;
}

// Draws half vectors (s, t), two rows of `pitch`. Fields as of a query, with the key of the draw's random
// numbers where a query has its half vector. A draw that leaves the disk is (2, 2).
WAVE_KERNEL void grid_draw(global const int* restrict fields, int pitch,
                           global float* restrict half_vectors) {
  const int first = WAVE_LANES * WAVE_ITEM_INDEX;
  const wave_uint key_low = wave_to_uint(GLINT_INT(MICA_GLINT_HALF_S)),
                  key_high = wave_to_uint(GLINT_INT(MICA_GLINT_HALF_T));
#define RANDOM(dimension) wave_random_uniform(key_low, key_high, (wave_uint)(uint)(dimension))
  const glint_lobe_shape shape = load_shape(fields, pitch, first);
  const wave_float one = 1.0f, outside = 2.0f;
  glint_level g;
  glint_place p = load_footprint(fields, pitch, first, &g);
  choose_level(RANDOM(DIMENSION_LEVEL), &p, &g);
  glint_disk_point square;  // the region is where this lies
  square.x = RANDOM(DIMENSION_DISK), square.y = RANDOM(DIMENSION_DISK + 1), square.density = one;
  place_footprint(&g, p.i, p.j, p.x, p.y, p.level, p.seed);
  place_angle(&g, square, one, one, p.level);

  const glint_region region = region_of(&g);
  const wave_uint word = wave_random_bits(key_low, key_high, (wave_uint)(uint)DIMENSION_GLINTS);
  const region_glint kept = draw_glint(&g, shape, region, word);
  const wave_float a = kept.a + draw_from_lobe(RANDOM(DIMENSION_LOBE), region.low_a - kept.a,
                                               region.high_a - kept.a, kept.inverse_a);
  const wave_float b = kept.b + draw_from_lobe(RANDOM(DIMENSION_LOBE + 1), region.low_b - kept.b,
                                               region.high_b - kept.b, kept.inverse_b);
  const wave_float turn = 6.28318531f * square.y, radius = 0.5f * sqrt(square.x);
  const wave_int is_uniform = wave_mask(RANDOM(DIMENSION_CHOICE) < UNIFORM_SHARE);
  const wave_float cell = wave_reciprocal(g.cells);
  const wave_float x = wave_select(fma(a, cell, square.x), fma(radius, cos(turn), 0.5f), is_uniform);
  const wave_float y = wave_select(fma(b, cell, square.y), fma(radius, sin(turn), 0.5f), is_uniform);

  const wave_float from_a = x - 0.5f, from_b = y - 0.5f;
  wave_float s, t;
  glint_from_disk(x, y, shape.alpha_x, shape.alpha_y, &s, &t);
  const wave_int inside = wave_mask(fma(from_a, from_a, from_b * from_b) < 0.25f);
  wave_store_float(wave_select(outside, s, inside), half_vectors + first);
  wave_store_float(wave_select(outside, t, inside), half_vectors + pitch + first);
}
