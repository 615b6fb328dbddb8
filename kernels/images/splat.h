// Lobes of normals into the image of a P-NDF: each over the pixels that it reaches. One wave owns a band of
// the image's rows and adds lobes one after the other, so that a pixel's sum has the same order whatever else
// runs.
#ifndef MICA_SPLAT_H
#define MICA_SPLAT_H

#include "images/image_types.h"
#include "pyramid/pyramid_elements.h"
#include "wave/gaussian.h"
#include "wave/wave.h"

#define SPLAT_FIELDS 8
#define SPLAT_RECORDS (SPLAT_FIELDS * WAVE_LANES)

// A band of an image, and room for sixteen lobes.
typedef struct {
  global float* image;
  WAVE_SHARED float* records;
  mica_image_window window;
  int first_row, last_row;  // rows of pixels
} splat_target;

// Band `index` of all images' bands.
static inline splat_target band_of(global float* images, mica_image_window window, int index,
                                   WAVE_SHARED float* records) {
  const int bands = (window.pixels + MICA_IMAGE_BAND - 1) / MICA_IMAGE_BAND;
  splat_target target;
  target.image = images + (size_t)(index / bands) * window.squares * window.squares * WAVE_LANES;
  target.records = records;
  target.window = window;
  target.first_row = index % bands * MICA_IMAGE_BAND;
  target.last_row = min(target.first_row + MICA_IMAGE_BAND, window.pixels) - 1;
  return target;
}

static inline int image_of_band(mica_image_window window, int index) {
  return index / ((window.pixels + MICA_IMAGE_BAND - 1) / MICA_IMAGE_BAND);
}

static inline void clear_band(splat_target target) {
  const wave_float nothing = 0.0f;
  const int first = target.first_row / MICA_IMAGE_SQUARE, last = target.last_row / MICA_IMAGE_SQUARE;
  for (int square = first * target.window.squares; square < (last + 1) * target.window.squares; ++square)
    wave_store_float(nothing, target.image + (size_t)square * WAVE_LANES);
}

// The band's half vectors in units of bounds.
static inline half_vector_box half_vectors_of(splat_target target) {
  const mica_image_window w = target.window;
  const float unit = MICA_BOUND_ONE;
  half_vector_box box;
  box.s_low = unit * w.left_s, box.s_high = unit * fma(w.step, (float)w.pixels, w.left_s);
  box.t_low = unit * fma(w.step, (float)target.first_row, w.bottom_t);
  box.t_high = unit * fma(w.step, (float)target.last_row, w.bottom_t);
  return box;
}

// One lobe: w exp2(a dx^2 + b dx dy + c dy^2) on the squares it reaches.
static inline void splat_one(splat_target target, int n) {
  WAVE_SHARED const float* record = target.records + n;
  const float x = record[0], y = record[WAVE_LANES], weight = record[2 * WAVE_LANES];
  const float a = record[3 * WAVE_LANES], b = record[4 * WAVE_LANES], c = record[5 * WAVE_LANES];
  const int columns = as_int(record[6 * WAVE_LANES]), rows = as_int(record[7 * WAVE_LANES]);
  const wave_float lane_x = wave_to_float(WAVE_LANE & 3), lane_y = wave_to_float(WAVE_LANE >> 2);
  for (int row = rows & 0xffff; row <= rows >> 16; ++row) {
    const wave_float dy = lane_y + ((float)(row * MICA_IMAGE_SQUARE) - y);
    const wave_float b_dy = b * dy, c_dy = c * dy * dy;
    global float* pixels = target.image + (size_t)row * target.window.squares * WAVE_LANES;
    for (int column = columns & 0xffff; column <= columns >> 16; ++column) {
      const wave_float dx = lane_x + ((float)(column * MICA_IMAGE_SQUARE) - x);
      const wave_float exponent = fma(dx, fma(a, dx, b_dy), c_dy);
      global float* square = pixels + column * WAVE_LANES;
      const wave_float sum = wave_load_float(square) + weight * gaussian_exp2(max(exponent, -126.0f));
      wave_store_float(sum, square);
    }
  }
}

// Sixteen lobes, whose `r` is that of the half vector zero; up to where their exponent is `cutoff`.
static inline void splat(splat_target target, private const element_lobes* lobes, float roughness,
                         float cutoff, float scale, WAVE_SHARED int* scratch) {
  const float to_pixels = roughness / target.window.step, last = (float)(target.window.pixels - 1);
  const float left = target.window.left_s / target.window.step,
              bottom = target.window.bottom_t / target.window.step;
  const wave_float x = fma(lobes->r_s, -to_pixels, -left), y = fma(lobes->r_t, -to_pixels, -bottom);
  const wave_float rest = max(cutoff - lobes->q_position, 1e-20f);
  const wave_float reach_s = rest * lobes->n_ss, reach_t = rest * lobes->n_tt;
  const wave_float reach_x = to_pixels * (reach_s * wave_rough_rsqrt(reach_s));
  const wave_float reach_y = to_pixels * (reach_t * wave_rough_rsqrt(reach_t));
  const wave_float low_x = max(x - reach_x, 0.0f), high_x = min(x + reach_x, last);
  const wave_float low_y = max(y - reach_y, (float)target.first_row),
                   high_y = min(y + reach_y, (float)target.last_row);
  const uint bits = wave_ballot(wave_mask(low_x <= high_x) & wave_mask(low_y <= high_y) &
                                    wave_mask(lobes->q_position < cutoff) & wave_mask(lobes->weight > 0.0f),
                                scratch);
  if (bits == 0) return;
  const float unit = -(EXP2_SCALE * EXP2_SCALE) / (to_pixels * to_pixels);
  const wave_float over_det = unit * lobes->root * lobes->root;
  const wave_float exponent = (-EXP2_SCALE * EXP2_SCALE) * lobes->q_position;
  wave_list_store(target.records, x);
  wave_list_store(target.records + WAVE_LANES, y);
  wave_list_store(target.records + 2 * WAVE_LANES,
                  scale * lobes->weight * gaussian_exp2(max(exponent, -126.0f)));
  wave_list_store(target.records + 3 * WAVE_LANES, over_det * lobes->n_tt);
  wave_list_store(target.records + 4 * WAVE_LANES, -2.0f * over_det * lobes->n_st);
  wave_list_store(target.records + 5 * WAVE_LANES, over_det * lobes->n_ss);
  // Squares of 4 pixels: first and last in one number.
  const wave_int columns = (wave_to_int(low_x) >> 2) | ((wave_to_int(high_x) >> 2) << 16);
  const wave_int rows = (wave_to_int(low_y) >> 2) | ((wave_to_int(high_y) >> 2) << 16);
  wave_list_store(target.records + 6 * WAVE_LANES, wave_from_bits(columns));
  wave_list_store(target.records + 7 * WAVE_LANES, wave_from_bits(rows));
  wave_list_sync();
  for (uint left_over = bits; left_over; left_over &= left_over - 1) splat_one(target, lowest_bit(left_over));
  wave_list_sync();
}

#endif  // MICA_SPLAT_H
