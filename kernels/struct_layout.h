// The layout of the structs that host and device share, as a list that both sides expand: SIZE(type) and
// OFFSET(type, field) for every struct and field of types.h.
#ifndef MICA_STRUCT_LAYOUT_H
#define MICA_STRUCT_LAYOUT_H

#define MICA_STRUCT_LAYOUT(SIZE, OFFSET)    \
  SIZE(mica_map_grid)                       \
  OFFSET(mica_map_grid, width)              \
  OFFSET(mica_map_grid, height)             \
  OFFSET(mica_map_grid, blocks_x)           \
  OFFSET(mica_map_grid, blocks_y)           \
  SIZE(mica_map_query)                      \
  OFFSET(mica_map_query, mean_i)            \
  OFFSET(mica_map_query, mean_j)            \
  OFFSET(mica_map_query, mean_x)            \
  OFFSET(mica_map_query, mean_y)            \
  OFFSET(mica_map_query, whiten_1x)         \
  OFFSET(mica_map_query, whiten_1y)         \
  OFFSET(mica_map_query, whiten_2x)         \
  OFFSET(mica_map_query, whiten_2y)         \
  OFFSET(mica_map_query, extent_x)          \
  OFFSET(mica_map_query, extent_y)          \
  OFFSET(mica_map_query, half_s)            \
  OFFSET(mica_map_query, half_t)            \
  OFFSET(mica_map_query, inverse_roughness) \
  OFFSET(mica_map_query, scale)             \
  OFFSET(mica_map_query, cutoff)            \
  OFFSET(mica_map_query, slot)              \
  SIZE(mica_mixture_query)                  \
  OFFSET(mica_mixture_query, map)           \
  OFFSET(mica_mixture_query, axis_1x)       \
  OFFSET(mica_mixture_query, axis_1y)       \
  OFFSET(mica_mixture_query, axis_2x)       \
  OFFSET(mica_mixture_query, axis_2y)       \
  OFFSET(mica_mixture_query, blur_1)        \
  OFFSET(mica_mixture_query, blur_2)        \
  OFFSET(mica_mixture_query, spread_variance) \
  OFFSET(mica_mixture_query, kernel_variance) \
  SIZE(mica_lobe_query)                     \
  OFFSET(mica_lobe_query, map)              \
  OFFSET(mica_lobe_query, slope_x)          \
  OFFSET(mica_lobe_query, slope_y)          \
  OFFSET(mica_lobe_query, slope_rest_x)     \
  OFFSET(mica_lobe_query, slope_rest_y)     \
  OFFSET(mica_lobe_query, slope_unit)       \
  OFFSET(mica_lobe_query, spread_variance)

#endif  // MICA_STRUCT_LAYOUT_H
