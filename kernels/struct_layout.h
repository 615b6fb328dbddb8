// The layout of the structs that host and device share, as a list that both sides expand: SIZE(type) and
// OFFSET(type, field) for every struct and field of types.h, pyramid/pyramid_types.h and
// images/image_types.h. tests/house/check_house.py sees that none is forgotten.
#ifndef MICA_STRUCT_LAYOUT_H
#define MICA_STRUCT_LAYOUT_H

#define MICA_STRUCT_LAYOUT(SIZE, OFFSET)             \
  SIZE(mica_map_grid)                                \
  OFFSET(mica_map_grid, width)                       \
  OFFSET(mica_map_grid, height)                      \
  OFFSET(mica_map_grid, blocks_x)                    \
  OFFSET(mica_map_grid, blocks_y)                    \
  SIZE(mica_map_query)                               \
  OFFSET(mica_map_query, mean_i)                     \
  OFFSET(mica_map_query, mean_j)                     \
  OFFSET(mica_map_query, mean_x)                     \
  OFFSET(mica_map_query, mean_y)                     \
  OFFSET(mica_map_query, whiten_1x)                  \
  OFFSET(mica_map_query, whiten_1y)                  \
  OFFSET(mica_map_query, whiten_2x)                  \
  OFFSET(mica_map_query, whiten_2y)                  \
  OFFSET(mica_map_query, extent_x)                   \
  OFFSET(mica_map_query, extent_y)                   \
  OFFSET(mica_map_query, half_s)                     \
  OFFSET(mica_map_query, half_t)                     \
  OFFSET(mica_map_query, inverse_roughness)          \
  OFFSET(mica_map_query, scale)                      \
  OFFSET(mica_map_query, cutoff)                     \
  OFFSET(mica_map_query, slot)                       \
  SIZE(mica_cavity_query)                            \
  OFFSET(mica_cavity_query, map)                     \
  OFFSET(mica_cavity_query, view_x)                  \
  OFFSET(mica_cavity_query, view_y)                  \
  OFFSET(mica_cavity_query, view_z)                  \
  OFFSET(mica_cavity_query, roughness)               \
  OFFSET(mica_cavity_query, seed_i)                  \
  OFFSET(mica_cavity_query, seed_j)                  \
  OFFSET(mica_cavity_query, key_low)                 \
  OFFSET(mica_cavity_query, key_high)                \
  OFFSET(mica_cavity_query, lobe_sigma)              \
  SIZE(mica_sampled_cavity_query)                    \
  OFFSET(mica_sampled_cavity_query, cavity)          \
  OFFSET(mica_sampled_cavity_query, mean_i)          \
  OFFSET(mica_sampled_cavity_query, mean_j)          \
  OFFSET(mica_sampled_cavity_query, mean_x)          \
  OFFSET(mica_sampled_cavity_query, mean_y)          \
  OFFSET(mica_sampled_cavity_query, sigma_x)         \
  OFFSET(mica_sampled_cavity_query, sigma_y)         \
  OFFSET(mica_sampled_cavity_query, shear)           \
  OFFSET(mica_sampled_cavity_query, step_x)          \
  OFFSET(mica_sampled_cavity_query, step_y)          \
  OFFSET(mica_sampled_cavity_query, blur_step)       \
  SIZE(mica_mixture_query)                           \
  OFFSET(mica_mixture_query, map)                    \
  OFFSET(mica_mixture_query, axis_1x)                \
  OFFSET(mica_mixture_query, axis_1y)                \
  OFFSET(mica_mixture_query, axis_2x)                \
  OFFSET(mica_mixture_query, axis_2y)                \
  OFFSET(mica_mixture_query, blur_1)                 \
  OFFSET(mica_mixture_query, blur_2)                 \
  OFFSET(mica_mixture_query, spread_variance)        \
  OFFSET(mica_mixture_query, kernel_variance)        \
  SIZE(mica_lobe_query)                              \
  OFFSET(mica_lobe_query, map)                       \
  OFFSET(mica_lobe_query, slope_x)                   \
  OFFSET(mica_lobe_query, slope_y)                   \
  OFFSET(mica_lobe_query, slope_rest_x)              \
  OFFSET(mica_lobe_query, slope_rest_y)              \
  OFFSET(mica_lobe_query, slope_unit)                \
  OFFSET(mica_lobe_query, spread_variance)           \
  SIZE(mica_slope_footprint)                         \
  OFFSET(mica_slope_footprint, offset)               \
  OFFSET(mica_slope_footprint, width)                \
  OFFSET(mica_slope_footprint, height)               \
  OFFSET(mica_slope_footprint, mean_unit)            \
  OFFSET(mica_slope_footprint, spread_unit)          \
  OFFSET(mica_slope_footprint, cell_i)               \
  OFFSET(mica_slope_footprint, cell_j)               \
  OFFSET(mica_slope_footprint, cell_x)               \
  OFFSET(mica_slope_footprint, cell_y)               \
  OFFSET(mica_slope_footprint, sigma_y)              \
  OFFSET(mica_slope_footprint, shear)                \
  OFFSET(mica_slope_footprint, sigma_x)              \
  SIZE(mica_patch_query)                             \
  OFFSET(mica_patch_query, lobe)                     \
  OFFSET(mica_patch_query, slopes)                   \
  OFFSET(mica_patch_query, view_x)                   \
  OFFSET(mica_patch_query, view_y)                   \
  OFFSET(mica_patch_query, view_z)                   \
  OFFSET(mica_patch_query, light_x)                  \
  OFFSET(mica_patch_query, light_y)                  \
  OFFSET(mica_patch_query, light_z)                  \
  OFFSET(mica_patch_query, weight)                   \
  SIZE(mica_smooth_query)                            \
  OFFSET(mica_smooth_query, map)                     \
  OFFSET(mica_smooth_query, slopes)                  \
  OFFSET(mica_smooth_query, slope_x)                 \
  OFFSET(mica_smooth_query, slope_y)                 \
  SIZE(mica_pyramid_query)                           \
  OFFSET(mica_pyramid_query, map)                    \
  OFFSET(mica_pyramid_query, cov_xx)                 \
  OFFSET(mica_pyramid_query, cov_xy)                 \
  OFFSET(mica_pyramid_query, cov_yy)                 \
  OFFSET(mica_pyramid_query, inverse_minor_variance) \
  OFFSET(mica_pyramid_query, group_size)             \
  SIZE(mica_image_window)                            \
  OFFSET(mica_image_window, left_s)                  \
  OFFSET(mica_image_window, bottom_t)                \
  OFFSET(mica_image_window, step)                    \
  OFFSET(mica_image_window, pixels)                  \
  OFFSET(mica_image_window, squares)                 \
  SIZE(mica_turned_lobe)                             \
  OFFSET(mica_turned_lobe, lobe_1s)                  \
  OFFSET(mica_turned_lobe, lobe_1t)                  \
  OFFSET(mica_turned_lobe, lobe_2s)                  \
  OFFSET(mica_turned_lobe, lobe_2t)                  \
  OFFSET(mica_turned_lobe, turn_1x)                  \
  OFFSET(mica_turned_lobe, turn_1y)                  \
  OFFSET(mica_turned_lobe, turn_2x)                  \
  OFFSET(mica_turned_lobe, turn_2y)                  \
  SIZE(mica_turned_query)                            \
  OFFSET(mica_turned_query, map)                     \
  OFFSET(mica_turned_query, lobe)                    \
  SIZE(mica_turned_mixture_query)                    \
  OFFSET(mica_turned_mixture_query, mixture)         \
  OFFSET(mica_turned_mixture_query, lobe)            \
  OFFSET(mica_turned_mixture_query, turn_sx)         \
  OFFSET(mica_turned_mixture_query, turn_sy)         \
  OFFSET(mica_turned_mixture_query, turn_tx)         \
  OFFSET(mica_turned_mixture_query, turn_ty)         \
  OFFSET(mica_turned_mixture_query, spread_turn)     \
  SIZE(mica_turned_smooth_query)                     \
  OFFSET(mica_turned_smooth_query, smooth)           \
  OFFSET(mica_turned_smooth_query, cross_xx)         \
  OFFSET(mica_turned_smooth_query, cross_xy)         \
  OFFSET(mica_turned_smooth_query, cross_yx)         \
  OFFSET(mica_turned_smooth_query, cross_yy)         \
  OFFSET(mica_turned_smooth_query, turn_xx)          \
  OFFSET(mica_turned_smooth_query, turn_xy)          \
  OFFSET(mica_turned_smooth_query, turn_yy)          \
  OFFSET(mica_turned_smooth_query, lobe_xx)          \
  OFFSET(mica_turned_smooth_query, lobe_xy)          \
  OFFSET(mica_turned_smooth_query, lobe_yy)          \
  SIZE(mica_turned_pyramid_query)                    \
  OFFSET(mica_turned_pyramid_query, pyramid)         \
  OFFSET(mica_turned_pyramid_query, lobe)            \
  OFFSET(mica_turned_pyramid_query, turn_sx)         \
  OFFSET(mica_turned_pyramid_query, turn_sy)         \
  OFFSET(mica_turned_pyramid_query, turn_tx)         \
  OFFSET(mica_turned_pyramid_query, turn_ty)         \
  OFFSET(mica_turned_pyramid_query, spread_turn)

#endif  // MICA_STRUCT_LAYOUT_H
