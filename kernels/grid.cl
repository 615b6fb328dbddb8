// `grid`: the P-NDF of glints on an implicit grid, in constant time. [Kem25] Algorithm 1.
//
// Glints are points of space x disk: one, at random, in every cell of a 4D grid. A query looks at the 2x2
// spatial and 2x2 angular cells around it on two levels of detail, and takes the expectation of all other
// glints. One lane a query: no lane waits for another.

#include "gaussian.h"
#include "glint_hash.h"
#include "glint_maps.h"
#include "types.h"
#include "wave.h"

#define INVERSE_TWO_PI 0.159154943f
#define LEAST_POWER -80.0f  // of two: what is less counts as zero, so that no product is a (slow) denormal
#define ROULETTE_SOFTNESS 0.1f  // epsilon of Eq. 8

// R(r, w) of Eq. 8: whether the glint with the number r is there at the weight w of its level.
static inline wave_float roulette(wave_float r, wave_float weight) {
  const wave_float low = max(r - ROULETTE_SOFTNESS, 0.0f), high = min(r + ROULETTE_SOFTNESS, 1.0f);
  const wave_float x = min(max((weight - low) * wave_reciprocal(high - low), 0.0f), 1.0f);
  return x * x * fma(-2.0f, x, 3.0f);
}

// A footprint and a direction on one level. Positions are relative to the lower left corner of the lowest of
// the 2x2 cells around them, 0.5 to 1.5 cells away.
typedef struct {
  wave_uint spatial_keys[4];        // of the spatial cells, x first
  wave_float x, y;                  // mean of the footprint
  wave_float w1x, w1y, w2x, w2y;    // its whitening
  wave_int k, l;                    // lowest angular cell
  wave_float a, b;                  // direction
  wave_float inverse_a, inverse_b;  // 1 / standard deviation of a lobe
  wave_float cells;                 // angular cells a side of the unit square
  wave_float center_a, center_b;    // direction less the centre of the disk, in cells
  wave_float weight;                // of the level
} glint_level;

// Share of a Gaussian around `x` that lies between `low` and `high`, both relative to it.
static inline wave_float share_between(wave_float low, wave_float high, wave_float inverse_sigma) {
  return gaussian_cdf_centred(CDF_SCALE * high * inverse_sigma) -
         gaussian_cdf_centred(CDF_SCALE * low * inverse_sigma);
}

// The sum of Eq. 5 over all sixteen cells, without the Gaussians' factors in front.
static inline wave_float sum_of_glints(private const glint_level* g) {
  const wave_float zero = 0.0f, radius2 = 0.25f * g->cells * g->cells;
  const wave_float w1x = EXP2_SCALE * g->w1x, w1y = EXP2_SCALE * g->w1y, w2x = EXP2_SCALE * g->w2x,
                   w2y = EXP2_SCALE * g->w2y;
  const wave_float n_a = EXP2_SCALE * g->inverse_a, n_b = EXP2_SCALE * g->inverse_b;
  wave_float sum = 0.0f;
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
      const wave_float p1 = fma(w1x, x, w1y * y), p2 = fma(w2x, x, w2y * y), p3 = n_a * a, p4 = n_b * b;
      const wave_float power = fma(-p1, p1, fma(-p2, p2, fma(-p3, p3, -p4 * p4)));
      const wave_float from_center_a = a + g->center_a, from_center_b = b + g->center_b;
      const wave_float center2 = fma(from_center_a, from_center_a, from_center_b * from_center_b);
      const wave_int counts = wave_mask(center2 < radius2) & wave_mask(power > LEAST_POWER);
      const wave_float chance = roulette(GLINT_HIGH(bits.roulette, 0.0f), g->weight);
      sum += wave_select(zero, gaussian_exp2(max(power, LEAST_POWER)) * chance, counts);
    }
  }
  return sum;
}

// What one level adds to D / D_smooth: its glints, and the expectation of those beyond its cells (Eqs. 10,
// 11).
static inline wave_float level_density(private const glint_level* g) {
  const wave_float determinant = fabs(fma(g->w1x, g->w2y, -g->w1y * g->w2x));
  // The footprint is cut where the cells end; what is left of it is brought back to a weight of one.
  const wave_float inverse_x = determinant * wave_rsqrt(fma(g->w1y, g->w1y, g->w2y * g->w2y));
  const wave_float inverse_y = determinant * wave_rsqrt(fma(g->w1x, g->w1x, g->w2x * g->w2x));
  const wave_float inside =
      share_between(-g->x, 2.0f - g->x, inverse_x) * share_between(-g->y, 2.0f - g->y, inverse_y);
  const wave_float scale =
      INVERSE_TWO_PI * INVERSE_TWO_PI * determinant * g->inverse_a * g->inverse_b * wave_reciprocal(inside);

  const wave_float half_square = 0.5f * g->cells;
  const wave_float low_a = -half_square - g->center_a, high_a = half_square - g->center_a;
  const wave_float low_b = -half_square - g->center_b, high_b = half_square - g->center_b;
  const wave_float square =
      share_between(low_a, high_a, g->inverse_a) * share_between(low_b, high_b, g->inverse_b);
  const wave_float cells = share_between(max(low_a, -g->a), min(high_a, 2.0f - g->a), g->inverse_a) *
                           share_between(max(low_b, -g->b), min(high_b, 2.0f - g->b), g->inverse_b);
  return fma(scale, sum_of_glints(g), g->weight * max(square - cells, 0.0f));
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
                                   wave_float fraction_y, wave_int level, uint seed) {
  const wave_int below_x = lower_half(fraction_x), below_y = lower_half(fraction_y);
  const wave_uint low_i = wave_to_uint(i + below_x), low_j = wave_to_uint(j + below_y);
  for (int cell = 0; cell < 4; ++cell) {
    const uint di = cell & 1, dj = cell >> 1;
    g->spatial_keys[cell] = glint_spatial_key(low_i + di, low_j + dj, wave_to_uint(level), seed);
  }
  g->x = fraction_x - wave_to_float(below_x), g->y = fraction_y - wave_to_float(below_y);
}

// Densities over the disk of half vectors. Global size: a lane for each query of the padded batch.
kernel void grid(global const int* restrict fields, int pitch, uint seed, global float* restrict density) {
  const int first = WAVE_LANES * WAVE_ITEM_INDEX;
#define FLOAT_FIELD(name) wave_load_float((global const float*)(fields + (name)*pitch + first))
#define INT_FIELD(name) wave_load_int(fields + (name)*pitch + first)
  const glint_disk_point direction =
      glint_to_disk(FLOAT_FIELD(MICA_GLINT_HALF_S), FLOAT_FIELD(MICA_GLINT_HALF_T),
                    FLOAT_FIELD(MICA_GLINT_INVERSE_ALPHA_X), FLOAT_FIELD(MICA_GLINT_INVERSE_ALPHA_Y));
  const wave_float jacobian = max(GLINT_DISK_AREA * direction.density, 1e-20f);  // |J_T|, Eq. 3
  const wave_float stretch = jacobian * wave_rsqrt(jacobian);
  const wave_float sigma_a = FLOAT_FIELD(MICA_GLINT_MICRO_S) * stretch,
                   sigma_b = FLOAT_FIELD(MICA_GLINT_MICRO_T) * stretch;
  wave_int level = INT_FIELD(MICA_GLINT_LEVEL), i = INT_FIELD(MICA_GLINT_CELL_I),
           j = INT_FIELD(MICA_GLINT_CELL_J);
  wave_float x = FLOAT_FIELD(MICA_GLINT_FRACTION_X), y = FLOAT_FIELD(MICA_GLINT_FRACTION_Y);

  glint_level g;
  g.w1x = FLOAT_FIELD(MICA_GLINT_WHITEN_1X), g.w1y = FLOAT_FIELD(MICA_GLINT_WHITEN_1Y);
  g.w2x = FLOAT_FIELD(MICA_GLINT_WHITEN_2X), g.w2y = FLOAT_FIELD(MICA_GLINT_WHITEN_2Y);
  g.weight = FLOAT_FIELD(MICA_GLINT_WEIGHT);
  wave_float sum = 0.0f;
  for (int n = 0; n < 2; ++n) {
    place_footprint(&g, i, j, x, y, level, seed);
    place_angle(&g, direction, sigma_a, sigma_b, level);
    sum += level_density(&g);
    // The next level: cells twice as wide in space, half as wide on the disk.
    x = 0.5f * (x + wave_to_float(i & 1)), y = 0.5f * (y + wave_to_float(j & 1));
    i >>= 1, j >>= 1, level += 1;
    g.w1x *= 2.0f, g.w1y *= 2.0f, g.w2x *= 2.0f, g.w2y *= 2.0f;
    g.weight = 1.0f - g.weight;
  }
  wave_store_float(direction.density * sum, density + first);
}

// T and T^-1 for points given as pairs of rows of `pitch`, for tests. Out: x, y, D, or s, t.
kernel void grid_to_disk(global const float* restrict half_vectors, int pitch, float alpha_x, float alpha_y,
                         global float* restrict points) {
  const int first = WAVE_LANES * WAVE_ITEM_INDEX;
  const wave_float inverse_x = 1.0f / alpha_x, inverse_y = 1.0f / alpha_y;
  const glint_disk_point point =
      glint_to_disk(wave_load_float(half_vectors + first), wave_load_float(half_vectors + pitch + first),
                    inverse_x, inverse_y);
  wave_store_float(point.x, points + first);
  wave_store_float(point.y, points + pitch + first);
  wave_store_float(point.density, points + 2 * pitch + first);
}

kernel void grid_from_disk(global const float* restrict points, int pitch, float alpha_x, float alpha_y,
                           global float* restrict half_vectors) {
  const int first = WAVE_LANES * WAVE_ITEM_INDEX;
  wave_float s, t;
  glint_from_disk(wave_load_float(points + first), wave_load_float(points + pitch + first), alpha_x, alpha_y,
                  &s, &t);
  wave_store_float(s, half_vectors + first);
  wave_store_float(t, half_vectors + pitch + first);
}
