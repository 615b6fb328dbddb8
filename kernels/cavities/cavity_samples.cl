// What leaves a footprint's V-shaped cavities after one bounce, as cavity_energies.cl says it, of a choice of
// the seeds under it: one in each cell of a lattice, [Che19] Eq. 15 as a sum of samples. Few footprints have
// more than some thousand cells, however wide they are. One wave a query.

#include "cavities/cavity.h"
#include "cavities/cavity_seeds.h"
#include "wave/gaussian.h"

// Standard deviations to which seeds count: all but 8e-3 of the weight.
#define SAMPLE_REACH 3.1f

static inline wave_int load_normals(global const int* normals, wave_int at) {
#if MICA_WAVE_ITEMS
  return normals[at];
#else
  return (int16)(normals[at.s0], normals[at.s1], normals[at.s2], normals[at.s3], normals[at.s4],
                 normals[at.s5], normals[at.s6], normals[at.s7], normals[at.s8], normals[at.s9],
                 normals[at.sa], normals[at.sb], normals[at.sc], normals[at.sd], normals[at.se],
                 normals[at.sf]);
#endif
}

// One component of the seeds whose texels are stored at `at`, between them and their neighbours.
static inline wave_float load_seeds(global const int* normals, wave_int at, wave_int right, wave_int up) {
  const wave_float own = wave_to_float(load_normals(normals, at));
  if (MICA_INTERPOLATION == 0 ? 1 : MICA_SEEDS == 1) return (1.0f / MICA_NORMAL_ONE) * own;
  const wave_float beside = wave_to_float(load_normals(normals, at + right));
  const wave_float above =
      wave_to_float(load_normals(normals, at + up)) + wave_to_float(load_normals(normals, at + right + up));
  return (0.25f / MICA_NORMAL_ONE) * ((own + beside) + above);
}

// `index` less whole periods. Half a step keeps the division clear of whole numbers.
static inline wave_int wrap_seeds(wave_int index, int period) {
  return index - period * wave_to_int(floor((wave_to_float(index) + 0.5f) * (1.0f / period)));
}

// Where a cell's seed lies in it, 0 to step - 1: a sequence of low discrepancy in two dimensions.
static inline wave_int place_in_cell(wave_float a, wave_float b, float turn_a, float turn_b, int step) {
  const wave_float turned = fma(a, turn_a, turn_b * b);
  return wave_to_int((turned - floor(turned)) * step);
}

// With which point of the blur a group of cells begins: neighbours with others.
static inline int first_blur(int column, int row, int step) {
  const float turned = fma((float)column, 0.18871942f, (float)row * 0.14246007f);
  return (int)((turned - floor(turned)) * step);
}

// E_1 of every query, in the order of their slots. Global size: queries (vectors), or 16 a query (items).
WAVE_KERNEL void cavity_samples(global const mica_sampled_cavity_query* restrict queries, int query_count,
                                mica_map_grid grid, global const int* restrict normals,
                                global float* restrict energy) {
  WAVE_DECLARE_SCRATCH(scratch);
  if (WAVE_ITEM_INDEX >= query_count) return;
  global const mica_sampled_cavity_query* query = queries + WAVE_ITEM_INDEX;
  const int rows = (int)ceil(SAMPLE_REACH * query->sigma_y / query->step_y),
            columns = (int)ceil(SAMPLE_REACH * query->sigma_x / query->step_x);
  const wave_float nothing = 0.0f;
  wave_float weights = nothing, energies = nothing;
  for (int row = -rows; row <= rows; row += 4) {
    const wave_int b = row + (WAVE_LANE >> 2);
    for (int column = -columns; column <= columns; column += 4) {
      const wave_int a = column + (WAVE_LANE & 3);
      const wave_float cell_a = wave_to_float(a), cell_b = wave_to_float(b);
      const wave_int j =
          b * query->step_y + place_in_cell(cell_a, cell_b, 0.75487767f, 0.56984029f, query->step_y);
      const wave_float y = wave_to_float(j) - query->mean_y;
      const wave_int i = a * query->step_x + wave_to_int(rint(fma(y, query->shear, query->mean_x))) +
                         place_in_cell(cell_a, cell_b, 0.56984029f, 0.75487767f, query->step_x);
      const wave_float x = wave_to_float(i) - query->mean_x;
      const wave_float p1 = (1.0f / query->sigma_x) * fma(-query->shear, y, x),
                       p2 = (1.0f / query->sigma_y) * y;
      const wave_float q = fma(p1, p1, p2 * p2);
      if (!wave_ballot(wave_mask(q <= SAMPLE_REACH * SAMPLE_REACH), scratch)) continue;

      const wave_int seed_i = wrap_seeds(query->mean_i + i, grid.width * MICA_SEEDS),
                     seed_j = wrap_seeds(query->mean_j + j, grid.height * MICA_SEEDS);
      const wave_int texel_i = seed_i / MICA_SEEDS, texel_j = seed_j / MICA_SEEDS;
      const wave_int block = texel_j / MICA_BLOCK * grid.blocks_x + texel_i / MICA_BLOCK;
      const wave_int at =
          block * MICA_BLOCK_STRIDE + (texel_j % MICA_BLOCK + 1) * MICA_BLOCK_ROW + texel_i % MICA_BLOCK + 1;
      const wave_int right = seed_i % MICA_SEEDS, up = seed_j % MICA_SEEDS * MICA_BLOCK_ROW;
      const wave_float weight = gaussian_exp2(max((-EXP2_SCALE * EXP2_SCALE) * q, -126.0f));
      weights += weight;
      const wave_float left = cavity_blurred_energy(
          load_seeds(normals, at, right, up), load_seeds(normals + MICA_BLOCK_PLANE, at, right, up),
          query->cavity.roughness, query->cavity.view_x, query->cavity.view_y, query->cavity.view_z,
          first_blur(column, row, query->blur_step), query->blur_step);
      energies = fma(weight, left, energies);
    }
  }
  const float all = wave_sum(weights, scratch), kept = wave_sum(energies, scratch);
  energy[query->cavity.map.slot] = all > 0.0f ? kept / all : 0.0f;
}
