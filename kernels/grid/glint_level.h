// A query of glints on one level of detail: where its cells are, and what their glints add up to. [Kem25]
#ifndef MICA_GLINT_LEVEL_H
#define MICA_GLINT_LEVEL_H

#include "grid/glint_hash.h"
#include "grid/glint_maps.h"
#include "grid/glint_turn.h"
#include "types.h"
#include "wave/gaussian.h"
#include "wave/wave.h"

// 1: processes of glints share the light, or leave out some of their glints (MICA_GLINT_PRESENCE).
#ifndef MICA_GLINT_ROULETTE
#define MICA_GLINT_ROULETTE 0
#endif
// Colours of glints: a density for each, which add up to D.
#ifndef MICA_GLINT_COLORS
#define MICA_GLINT_COLORS 1
#endif

#define LEAST_POWER \
  -80.0f  // a power of two: what is less counts as zero, so that no product is a (slow) denormal
#define ROULETTE_SOFTNESS 0.1f  // epsilon of Eq. 8

// R(r, w) of Eq. 8: whether the glint with the number r is there at the weight w of its level.
static inline wave_float roulette(wave_float r, wave_float weight) {
  const wave_float low = max(r - ROULETTE_SOFTNESS, 0.0f), high = min(r + ROULETTE_SOFTNESS, 1.0f);
  const wave_float x = min(max((weight - low) * wave_reciprocal(high - low), 0.0f), 1.0f);
  return x * x * fma(-2.0f, x, 3.0f);
}

// Whether a glint with the number r is there when a share of them is: as smooth as the roulette of levels,
// but its mean over r is the share itself, so that processes which share the light lose none of it.
static inline wave_float presence_of(wave_float r, wave_float share, wave_float inverse_width) {
  const wave_float x = min(max(fma(share - r, inverse_width, 0.5f), 0.0f), 1.0f);
  return x * x * fma(-2.0f, x, 3.0f);
}

// A footprint and a direction on one level. Positions are relative to the lower left corner of the lowest of
// the 2x2 cells around them, 0.5 to 1.5 cells away.
typedef struct {
  wave_uint spatial_keys[4];                              // keys of the spatial cells, x first
  wave_float x, y;                                        // mean of the footprint
  wave_float w1x, w1y, w2x, w2y;                          // its whitening
  wave_int k, l;                                          // lowest angular cell
  wave_float a, b;                                        // direction
  wave_float inverse_a, inverse_b;                        // 1 / standard deviation of a lobe
  wave_float cells;                                       // angular cells a side of the unit square
  wave_float center_a, center_b;                          // direction less the centre of the disk, in cells
  wave_float weight;                                      // weight of the level
  wave_float share, presence, inverse_width, brightness;  // what the process has, where MICA_GLINT_ROULETTE
#if MICA_FIRST_ORDER
  glint_turn turn;
#endif
} glint_level;

typedef struct {
  wave_float of_color[MICA_GLINT_COLORS];
} glint_density;

// Share of a Gaussian around `x` that lies between `low` and `high`, both relative to it.
static inline wave_float share_between(wave_float low, wave_float high, wave_float inverse_sigma) {
  return gaussian_cdf_centred(CDF_SCALE * high * inverse_sigma) -
         gaussian_cdf_centred(CDF_SCALE * low * inverse_sigma);
}

// The sum of Eq. 5 over all sixteen cells, without the Gaussians' factors in front.
static inline glint_density sum_of_glints(private const glint_level* g) {
  const wave_float zero = 0.0f, radius2 = 0.25f * g->cells * g->cells;
  const wave_float w1x = EXP2_SCALE * g->w1x, w1y = EXP2_SCALE * g->w1y, w2x = EXP2_SCALE * g->w2x,
                   w2y = EXP2_SCALE * g->w2y;
  const wave_float n_a = EXP2_SCALE * g->inverse_a, n_b = EXP2_SCALE * g->inverse_b;
#if MICA_FIRST_ORDER
  const glint_turn turn = g->turn;
#endif
  glint_density sum;
  for (int color = 0; color < MICA_GLINT_COLORS; ++color) sum.of_color[color] = zero;
  for (int angular = 0; angular < 4; ++angular) {
    const int dk = angular & 1, dl = angular >> 1;
    const wave_uint angular_key = glint_angular_key(wave_to_uint(g->k + dk), wave_to_uint(g->l + dl));
    const wave_float from_a = (float)dk - g->a, from_b = (float)dl - g->b;
#pragma unroll
    for (int cell = 0; cell < 4; ++cell) {
      const int di = cell & 1, dj = cell >> 1;
      const glint_bits bits = glint_draw(g->spatial_keys[cell], angular_key);
      const wave_float x = GLINT_LOW(bits.place, (float)di - g->x),
                       y = GLINT_HIGH(bits.place, (float)dj - g->y);
      const wave_float a = GLINT_LOW(bits.angle, from_a), b = GLINT_HIGH(bits.angle, from_b);
      const wave_float p1 = fma(w1x, x, w1y * y), p2 = fma(w2x, x, w2y * y);
#if MICA_FIRST_ORDER
      const wave_float p3 = fma(n_a, a, -fma(turn.a1, p1, turn.a2 * p2));
      const wave_float p4 = fma(n_b, b, -fma(turn.shear, n_a * a, fma(turn.b1, p1, turn.b2 * p2)));
#else
      const wave_float p3 = n_a * a, p4 = n_b * b;
#endif
      const wave_float power = fma(-p1, p1, fma(-p2, p2, fma(-p3, p3, -p4 * p4)));
      const wave_float from_center_a = a + g->center_a, from_center_b = b + g->center_b;
      const wave_float center2 = fma(from_center_a, from_center_a, from_center_b * from_center_b);
      const wave_int counts = wave_mask(center2 < radius2) & wave_mask(power > LEAST_POWER);
      const wave_float chance = roulette(GLINT_HIGH(bits.roulette, 0.0f), g->weight);
      wave_float value = wave_select(zero, gaussian_exp2(max(power, LEAST_POWER)) * chance, counts);
#if MICA_GLINT_ROULETTE || MICA_GLINT_COLORS > 1
      const wave_uint more = glint_draw_more(bits);
#endif
#if MICA_GLINT_ROULETTE
      value *= presence_of(GLINT_HIGH(more, 0.0f), g->presence, g->inverse_width);
#endif
#if MICA_GLINT_COLORS > 1
      const wave_int color_of_glint = wave_to_int((more & 0xffffu) * (uint)MICA_GLINT_COLORS >> 16);
      for (int color = 0; color < MICA_GLINT_COLORS; ++color)
        sum.of_color[color] += wave_select(zero, value, wave_mask(color_of_glint == color));
#else
      sum.of_color[0] += value;
#endif
    }
  }
  return sum;
}

// What one level adds to D / D_smooth: its glints, and the expectation of those beyond its cells (Eqs. 10,
// 11).
static inline void add_level(private const glint_level* g, private glint_density* density) {
  const wave_float determinant = fabs(fma(g->w1x, g->w2y, -g->w1y * g->w2x));
  // The footprint is cut where the cells end; what is left of it is brought back to a weight of one.
  const wave_float inverse_x = determinant * wave_rsqrt(fma(g->w1y, g->w1y, g->w2y * g->w2y));
  const wave_float inverse_y = determinant * wave_rsqrt(fma(g->w1x, g->w1x, g->w2x * g->w2x));
  const wave_float inside =
      share_between(-g->x, 2.0f - g->x, inverse_x) * share_between(-g->y, 2.0f - g->y, inverse_y);
  wave_float scale =
      INVERSE_TWO_PI * INVERSE_TWO_PI * determinant * g->inverse_a * g->inverse_b * wave_reciprocal(inside);
  wave_float expected_weight = g->weight * (1.0f / MICA_GLINT_COLORS);
#if MICA_GLINT_ROULETTE
  scale *= g->brightness, expected_weight *= g->share;
#endif

  const wave_float half_square = 0.5f * g->cells;
  const wave_float low_a = -half_square - g->center_a, high_a = half_square - g->center_a;
  const wave_float low_b = -half_square - g->center_b, high_b = half_square - g->center_b;
#if MICA_FIRST_ORDER
  const wave_float inverse_a = wave_reciprocal(g->turn.spread_a * g->cells),
                   inverse_b = wave_reciprocal(g->turn.spread_b * g->cells);
#else
  const wave_float inverse_a = g->inverse_a, inverse_b = g->inverse_b;
#endif
  const wave_float square = share_between(low_a, high_a, inverse_a) * share_between(low_b, high_b, inverse_b);
  const wave_float from_a = max(low_a, -g->a), to_a = min(high_a, 2.0f - g->a);
  const wave_float from_b = max(low_b, -g->b), to_b = min(high_b, 2.0f - g->b);
  wave_float cells = share_between(from_a, to_a, inverse_a) * share_between(from_b, to_b, inverse_b);
#if MICA_FIRST_ORDER
  cells += share_by_correlation(inverse_a * from_a, inverse_a * to_a, inverse_b * from_b, inverse_b * to_b,
                                g->turn.tangent);
#endif
  const wave_float expected = expected_weight * max(square - cells, 0.0f);
  const glint_density sum = sum_of_glints(g);
  for (int color = 0; color < MICA_GLINT_COLORS; ++color)
    density->of_color[color] += fma(scale, sum.of_color[color], expected);
}

// Lower end of the 2x2 cells around a fraction: one cell below where it lies in the lower half.
static inline wave_int lower_half(wave_float fraction) {
  return wave_mask(fraction < 0.5f);
}

static inline void place_angle(private glint_level* g, glint_disk_point direction, wave_float sigma_a,
                               wave_float sigma_b, wave_int level) {
  g->cells = wave_from_bits((level + 127) << 23);  // 2^level
  const wave_float a = direction.x * g->cells, b = direction.y * g->cells;
  const wave_int whole_a = wave_to_int(a), whole_b = wave_to_int(b);
  const wave_float fraction_a = a - wave_to_float(whole_a), fraction_b = b - wave_to_float(whole_b);
  const wave_int below_a = lower_half(fraction_a), below_b = lower_half(fraction_b);
  g->k = whole_a + below_a, g->l = whole_b + below_b;
  g->a = fraction_a - wave_to_float(below_a), g->b = fraction_b - wave_to_float(below_b);
  g->center_a = (direction.x - 0.5f) * g->cells, g->center_b = (direction.y - 0.5f) * g->cells;
  g->inverse_a = wave_reciprocal(sigma_a * g->cells), g->inverse_b = wave_reciprocal(sigma_b * g->cells);
}

static inline void place_footprint(private glint_level* g, wave_int i, wave_int j, wave_float fraction_x,
                                   wave_float fraction_y, wave_int level, wave_uint seed) {
  const wave_int below_x = lower_half(fraction_x), below_y = lower_half(fraction_y);
  const wave_uint low_i = wave_to_uint(i + below_x), low_j = wave_to_uint(j + below_y);
  for (int cell = 0; cell < 4; ++cell) {
    const uint di = cell & 1, dj = cell >> 1;
    g->spatial_keys[cell] = glint_spatial_key(low_i + di, low_j + dj, wave_to_uint(level), seed);
  }
  g->x = fraction_x - wave_to_float(below_x), g->y = fraction_y - wave_to_float(below_y);
}

// A query on the finer of its two levels, but for its direction.
typedef struct {
  wave_int level, i, j;  // cell of the mean
  wave_float x, y;       // where in it
  wave_uint seed;
} glint_place;

static inline glint_place load_footprint(global const int* fields, int pitch, int first,
                                         private glint_level* g) {
  g->w1x = GLINT_FLOAT(MICA_GLINT_WHITEN_1X), g->w1y = GLINT_FLOAT(MICA_GLINT_WHITEN_1Y);
  g->w2x = GLINT_FLOAT(MICA_GLINT_WHITEN_2X), g->w2y = GLINT_FLOAT(MICA_GLINT_WHITEN_2Y);
  g->weight = GLINT_FLOAT(MICA_GLINT_WEIGHT);
#if MICA_GLINT_ROULETTE
  g->share = GLINT_FLOAT(MICA_GLINT_SHARE), g->presence = GLINT_FLOAT(MICA_GLINT_PRESENCE);
  g->brightness = GLINT_FLOAT(MICA_GLINT_BRIGHTNESS);
  const wave_float softness = min(min(g->presence, 1.0f - g->presence), ROULETTE_SOFTNESS);
  g->inverse_width = 0.5f * wave_reciprocal(max(softness, 1e-6f));
#endif
  glint_place place;
  place.level = GLINT_INT(MICA_GLINT_LEVEL);
  place.i = GLINT_INT(MICA_GLINT_CELL_I), place.j = GLINT_INT(MICA_GLINT_CELL_J);
  place.x = GLINT_FLOAT(MICA_GLINT_FRACTION_X), place.y = GLINT_FLOAT(MICA_GLINT_FRACTION_Y);
  place.seed = wave_to_uint(GLINT_INT(MICA_GLINT_SEED));
  return place;
}

// To the next level: cells twice as wide in space, half as wide on the disk.
static inline void next_level(private glint_place* p, private glint_level* g) {
  p->x = 0.5f * (p->x + wave_to_float(p->i & 1)), p->y = 0.5f * (p->y + wave_to_float(p->j & 1));
  p->i >>= 1, p->j >>= 1, p->level += 1;
  g->w1x *= 2.0f, g->w1y *= 2.0f, g->w2x *= 2.0f, g->w2y *= 2.0f;
  g->weight = 1.0f - g->weight;
}

#endif  // MICA_GLINT_LEVEL_H
