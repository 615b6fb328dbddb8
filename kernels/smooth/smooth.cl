// `smooth`: the P-NDF of a footprint as one Beckmann lobe with the mean and the covariance of its slopes, at
// the cost of a few cells of their pyramid. Glints are lost: the baseline. After Dupuy et al., "Linear
// Efficient Antialiased Displacement and Reflectance Mapping", 2013.

#include "beckmanns/footprint_slopes.h"
#include "types.h"
#include "wave/wave.h"

// 1: the half vector turns over the footprint, and the lobe need not be round.
#if MICA_FIRST_ORDER
#include "smooth/turned_slopes.h"
typedef mica_turned_smooth_query smooth_query;
#define SMOOTH(query) (&(query)->smooth)
#else
typedef mica_smooth_query smooth_query;
#define SMOOTH(query) (query)
#endif

// Density of every query, in the order of their slots. Global size: queries (vectors), or 16 a query (items).
// The grid is that of the finest level.
WAVE_KERNEL void smooth(global const smooth_query* restrict queries, int query_count, mica_map_grid grid,
                        global const short* restrict pyramid, global float* restrict density) {
  WAVE_DECLARE_SCRATCH(scratch);
  (void)grid;
  if (WAVE_ITEM_INDEX >= query_count) return;
  global const mica_smooth_query* query = SMOOTH(queries + WAVE_ITEM_INDEX);
  const slope_lobe slopes = footprint_slopes(&query->slopes, pyramid, scratch);
#if MICA_FIRST_ORDER
  const slope_lobe lobe = turned_slopes(queries + WAVE_ITEM_INDEX, slopes, scratch);
#else
  const slope_lobe lobe = with_roughness(slopes, query->map.inverse_roughness, scratch);
#endif
  // The Cholesky factor of the covariance whitens the half vector's slope.
  const float a = sqrt(lobe.xx), b = lobe.xy / a, c = sqrt(max(fma(-b, b, lobe.yy), 1e-6f * lobe.yy));
  const float r_1 = (query->slope_x - lobe.mean_x) / a, r_2 = (query->slope_y - lobe.mean_y - b * r_1) / c;
  density[query->map.slot] = query->map.scale / (a * c) * exp(-0.5f * fma(r_1, r_1, r_2 * r_2));
}
