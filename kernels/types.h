// Structs that host and device share: scalar fields only, the same bytes on both sides.
#ifndef MICA_TYPES_H
#define MICA_TYPES_H

#ifndef __cplusplus
#define MICA_INT int
#define MICA_FLOAT float
#else
#include <cstddef>
#include <cstdint>
#define MICA_INT std::int32_t
#define MICA_FLOAT float
namespace mica::host::device_types {
#endif

// Storage of a normal map. A block is 64x64 texels with an apron of one texel below and left, two above and
// right, so that bilinear and bicubic quads find all their corners in one block.
enum {
  MICA_BLOCK = 64,           // texels a side
  MICA_BLOCK_ROW = 67,       // stored texels a row: apron included
  MICA_BLOCK_PLANE = 4489,   // stored texels of one component: 67 * 67
  MICA_BLOCK_STRIDE = 8978,  // ints a block: the s plane, then the t plane
  MICA_NORMALS_PADDING = 8,  // ints after the last block: whole vectors are read
  MICA_TILE = 16,            // texels a side; sixteen tiles a block
  MICA_LEAF = 4,             // texels a side; sixteen leaves a tile
  MICA_NODE_STRIDE = 64,     // shorts a node: s_min[16], s_max[16], t_min[16], t_max[16]
  // Shorts a node of a mixture, sixteen of each: an axis x, y; the elements' means along it min, max and
  // across it min, max; how far elements spread along and across.
  MICA_MIXTURE_NODE_STRIDE = 128,
  MICA_SPREAD_UNIT = 2,  // unit of the spreads of `gaussians`, in units of their means
  // Shorts a leaf of lobes: mean_x[16], mean_y[16], and the rows of the spread's Cholesky factor xx[16],
  // yx[16], yy[16]; then four floats: the mean that the means are counted from, x and y, and the units of
  // means and of spreads.
  MICA_LOBE_LEAF = 88,
  MICA_SLOPE_APRON = 3  // cells right of and above a level of the pyramid of slopes: whole 4x4 cells are read
};

// Normals (s, t) are 32-bit fixed point: the difference of two is exact, and 2^-30 is fine enough for
// roughness 1e-5.
#define MICA_NORMAL_ONE 1073741824  // 2^30
// Bounds are 16-bit fixed point, rounded outwards.
#define MICA_BOUND_ONE 32767

// Fields of a batch of glint queries: field f of query n is fields[f * pitch + n], all of four bytes.
enum {
  MICA_GLINT_CELL_I,  // int: the spatial cell of the mean on the finer level, modulo 2^32
  MICA_GLINT_CELL_J,
  MICA_GLINT_FRACTION_X,  // where in that cell the mean is, in [0, 1)
  MICA_GLINT_FRACTION_Y,
  MICA_GLINT_WHITEN_1X,  // rows of W with W^T W = covariance^-1, in cells of the finer level
  MICA_GLINT_WHITEN_1Y,
  MICA_GLINT_WHITEN_2X,
  MICA_GLINT_WHITEN_2Y,
  MICA_GLINT_LEVEL,   // int: the finer level l; its angular cells have a width of 2^-l
  MICA_GLINT_WEIGHT,  // weight of the finer level, in [0, 1]; the next has the rest
  MICA_GLINT_HALF_S,  // half vector on the unit disk
  MICA_GLINT_HALF_T,
  MICA_GLINT_INVERSE_ALPHA_X,  // 1 / roughness of the smooth distribution
  MICA_GLINT_INVERSE_ALPHA_Y,
  MICA_GLINT_MICRO_S,  // standard deviation of one glint's lobe on the disk of half vectors
  MICA_GLINT_MICRO_T,
  MICA_GLINT_SEED,        // int
  MICA_GLINT_SHARE,       // share of the light, for this process
  MICA_GLINT_PRESENCE,    // share of its glints that are there: share * kept
  MICA_GLINT_BRIGHTNESS,  // 1 / kept: of the glints that are there
  MICA_GLINT_FIELDS,
  // What queries have besides whose half vector turns, or whose lobe is not round (MICA_FIRST_ORDER), all on
  // the unit square that the disk of half vectors is mapped to. A lobe has a Cholesky factor (a 0; c b).
  MICA_GLINT_LOBE_A = MICA_GLINT_FIELDS,  // a
  MICA_GLINT_LOBE_B,                      // b
  MICA_GLINT_LOBE_SHEAR,                  // c / b
  MICA_GLINT_TURN_A1,  // (a 0; c b)^-1 times the turn over a standard deviation along the first row of W ...
  MICA_GLINT_TURN_A2,  // ... and along the second
  MICA_GLINT_TURN_B1,
  MICA_GLINT_TURN_B2,
  MICA_GLINT_SPREAD_A,  // standard deviations of lobe and turn together
  MICA_GLINT_SPREAD_B,
  MICA_GLINT_SPREAD_TANGENT,  // of half the arcsine of their correlation, in (-1, 1)
  MICA_GLINT_DENSITY,  // mean of the smooth distribution over the footprint, on the disk of half vectors
  MICA_GLINT_TURNED_FIELDS,
  MICA_GLINT_PADDING = 256  // queries: a batch is padded to whole work-groups
};

// The map as the kernels see it. Texels are counted from the bottom left.
typedef struct {
  MICA_INT width, height;       // texels
  MICA_INT blocks_x, blocks_y;  // blocks a period; the last ones may be partly filled
} mica_map_grid;

// One query in texel units. [Yan14] Eq. 6.
typedef struct {
  MICA_INT mean_i, mean_j;          // footprint mean, whole texels, in [0, width) x [0, height)
  MICA_FLOAT mean_x, mean_y;        // and the rest, in [0, 1)
  MICA_FLOAT whiten_1x, whiten_1y;  // rows of W with W^T W = covariance^-1: the axes of the
  MICA_FLOAT whiten_2x, whiten_2y;  // footprint, each divided by its standard deviation in texels
  MICA_FLOAT extent_x, extent_y;    // half the footprint's bounding box at the cutoff, texels
  MICA_INT half_s, half_t;          // half vector, fixed point like the normals
  MICA_FLOAT inverse_roughness;     // 1 / sigma_r
  MICA_FLOAT scale;                 // 1 / (4 pi^2 sqrt(det covariance) sigma_r^2): the peak of G_p G_r
  MICA_FLOAT cutoff;  // c^2: where |whitened residual|^2 is larger, the integrand counts as zero
  MICA_INT slot;      // where the result goes
} mica_map_query;

// A half vector that turns over the footprint, and a lobe that need not be round. With the lobe's axes, each
// divided by its standard deviation, as the rows of L, and a turn of H a texel: normals less the half vector
// are whitened by L, and less L H (x, y) at (x, y) texels from the footprint's mean.
typedef struct {
  MICA_FLOAT lobe_1s, lobe_1t;  // L
  MICA_FLOAT lobe_2s, lobe_2t;
  MICA_FLOAT turn_1x, turn_1y;  // L H
  MICA_FLOAT turn_2x, turn_2y;
} mica_turned_lobe;

// A query with one.
typedef struct {
  mica_map_query map;  // of which inverse_roughness is not used
  mica_turned_lobe lobe;
} mica_turned_query;

// What is asked of V-shaped cavities about all light from a view. [Che19]
typedef struct {
  mica_map_query map;                 // its normals do not matter
  MICA_FLOAT view_x, view_y, view_z;  // unit, above the horizon
  MICA_FLOAT roughness;               // standard deviation on the disk
  MICA_INT seed_i, seed_j;     // where a draw starts: in [0, width) x [0, height) times the seeds a texel
  MICA_INT key_low, key_high;  // key of its random numbers
  MICA_FLOAT lobe_sigma;       // standard deviation of (i_x, i_y) in the specular compensation
} mica_cavity_query;

// The same for a choice of the seeds under a footprint: one at a random place of each cell of a lattice,
// whose rows lean as the footprint does.
typedef struct {
  mica_cavity_query cavity;
  MICA_INT mean_i,
      mean_j;  // footprint mean, whole seeds, in [0, width) x [0, height) times the seeds a texel
  MICA_FLOAT mean_x, mean_y;    // and the rest, in [0, 1)
  MICA_FLOAT sigma_x, sigma_y;  // standard deviations along a row, and of the rows, in seeds
  MICA_FLOAT shear;             // how far a row's middle lies aside, over its distance from the mean
  MICA_INT step_x, step_y;      // sides of a cell, in seeds
  MICA_INT blur_step;  // 1 to 16, a power of two: of the points of the blur a cell has every blur_step-th
} mica_sampled_cavity_query;

// One query of a Gaussian mixture, in texel units. [Yan16]. With tau_i^2 = sigma_i^2 + k, sigma_i and a_i the
// footprint's standard deviations and axes, k the variance of the elements' position kernel.
typedef struct {
  mica_map_query map;  // its whitening and extent are for culling: of a footprint that is wide enough
  MICA_FLOAT axis_1x, axis_1y;  // a_1 / tau_1: whitens an element's centre
  MICA_FLOAT axis_2x, axis_2y;  // a_2 / tau_2
  MICA_FLOAT blur_1,
      blur_2;  // sqrt(k) sigma_i / sigma_r: times J a_i / tau_i, what the slice's normals spread by
  MICA_FLOAT spread_variance;  // what a squared `spread` of a node counts for, in roughnesses squared
  MICA_FLOAT kernel_variance;  // k
} mica_mixture_query;

// The same with a turned lobe; the mixture's inverse_roughness is that of the lobe's major axis, for culling,
// and its blurs are of the disk.
typedef struct {
  mica_mixture_query mixture;
  mica_turned_lobe lobe;
  MICA_FLOAT turn_sx, turn_sy;  // H a texel, on the disk
  MICA_FLOAT turn_tx, turn_ty;
  MICA_FLOAT
  spread_turn;  // what it adds to an element's variance, at most, in squares of the lobe's major axis
} mica_turned_mixture_query;

// One query of a mixture of Beckmann lobes; `map` is in units of an element, and its half_s, half_t are not
// used. [Che18] Eq. 9.
typedef struct {
  mica_map_query map;
  MICA_FLOAT slope_x, slope_y;            // slope of the half vector,
  MICA_FLOAT slope_rest_x, slope_rest_y;  // and what floats leave of it
  MICA_FLOAT slope_unit;                  // unit of the bounds of nodes
  MICA_FLOAT spread_variance;  // what a squared `spread` of a node counts for, in roughnesses squared
} mica_lobe_query;

// A footprint on a level of the pyramid of slopes, in cells: a Gaussian of the cells' weights.
typedef struct {
  MICA_INT offset;  // where the level's first number is; -1: the footprint is too small for all of them
  MICA_INT width, height;              // cells a period
  MICA_FLOAT mean_unit, spread_unit;   // units of its numbers
  MICA_INT cell_i, cell_j;             // mean, whole cells
  MICA_FLOAT cell_x, cell_y;           // and the rest, in [0, 1)
  MICA_FLOAT sigma_y, shear, sigma_x;  // y has sigma_y, x given y the mean shear * y and sigma_x
} mica_slope_footprint;

// One question of a patch BRDF. [Che18] Eq. 7
typedef struct {
  mica_lobe_query lobe;  // what is asked about the half vector
  mica_slope_footprint slopes;
  MICA_FLOAT view_x, view_y, view_z;
  MICA_FLOAT light_x, light_y, light_z;
  MICA_FLOAT weight;  // weight of an element at the footprint's mean
} mica_patch_query;

// One query of `smooth`.
typedef struct {
  mica_map_query map;  // it uses slot, inverse_roughness and scale
  mica_slope_footprint slopes;
  MICA_FLOAT slope_x, slope_y;  // slope of the half vector
} mica_smooth_query;

// The same with a half vector that turns and a lobe that need not be round. With the turn T of slopes a cell,
// W the covariance of the cells' weights and C that of the footprint in cells, slopes whose covariance with
// the cells' places is X have that of X W^-1 C with the footprint.
typedef struct {
  mica_smooth_query smooth;       // of which inverse_roughness is not used
  MICA_FLOAT cross_xx, cross_xy;  // W^-1 C T'
  MICA_FLOAT cross_yx, cross_yy;
  MICA_FLOAT turn_xx, turn_xy, turn_yy;  // T C T'
  MICA_FLOAT lobe_xx, lobe_xy, lobe_yy;  // the lobe's covariance on the disk
} mica_turned_smooth_query;

#ifdef __cplusplus
static_assert(sizeof(mica_slope_footprint) == 48 && offsetof(mica_slope_footprint, sigma_y) == 36);
static_assert(sizeof(mica_patch_query) == 164 && offsetof(mica_patch_query, weight) == 160);
static_assert(sizeof(mica_smooth_query) == 120 && offsetof(mica_smooth_query, slope_x) == 112);
static_assert(sizeof(mica_lobe_query) == 88 && offsetof(mica_lobe_query, slope_x) == 64 &&
              offsetof(mica_lobe_query, spread_variance) == 84);
static_assert(sizeof(mica_mixture_query) == 96 && offsetof(mica_mixture_query, axis_1x) == 64 &&
              offsetof(mica_mixture_query, kernel_variance) == 92);
static_assert(sizeof(mica_cavity_query) == 100 && offsetof(mica_cavity_query, lobe_sigma) == 96);
static_assert(sizeof(mica_sampled_cavity_query) == 140 &&
              offsetof(mica_sampled_cavity_query, blur_step) == 136);
static_assert(sizeof(mica_turned_lobe) == 32 && offsetof(mica_turned_lobe, turn_2y) == 28);
static_assert(sizeof(mica_turned_query) == 96 && offsetof(mica_turned_query, lobe) == 64);
static_assert(sizeof(mica_turned_mixture_query) == 148 &&
              offsetof(mica_turned_mixture_query, spread_turn) == 144);
static_assert(sizeof(mica_turned_smooth_query) == 160 && offsetof(mica_turned_smooth_query, lobe_xx) == 148);
static_assert(sizeof(mica_map_grid) == 16 && offsetof(mica_map_grid, blocks_x) == 8);
static_assert(sizeof(mica_map_query) == 64 && offsetof(mica_map_query, whiten_1x) == 16 &&
              offsetof(mica_map_query, half_s) == 40 && offsetof(mica_map_query, slot) == 60);
}  // namespace mica::host::device_types
#endif

#undef MICA_INT
#undef MICA_FLOAT
#endif  // MICA_TYPES_H
