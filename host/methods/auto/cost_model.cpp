#include "host/methods/auto/cost_model.h"

#include "host/methods/map/map_query.h"
#include "kernels/types.h"

namespace mica::host {

double blocks_reached(const Query& query, int map_width, int map_height) {
  constexpr double reach = 4.3;  // of a mixture's cutoff, standard deviations
  const FootprintAxes axes = footprint_axes(without_needless_periods(query.footprint), map_width, map_height);
  const auto blocks = [](double sigma) { return 1 + 2 * reach * sigma / device_types::MICA_BLOCK; };
  return blocks(axes.sigma_major_texels) * blocks(axes.sigma_minor_texels);
}

CostModel gaussians_cost(int elements, bool first_order) {
  if (elements == 1) return first_order ? CostModel{905, 879, 3.62, 105} : CostModel{539, 970, 2.88, 105};
  if (elements == 2) return first_order ? CostModel{152, 1260, 11.1, 240} : CostModel{0, 1110, 9.56, 240};
  return first_order ? CostModel{0, 2000, 37.8, 800} : CostModel{0, 1440, 33.4, 800};
}
CostModel triangles_cost(Interpolation interpolation, bool first_order) {
  if (interpolation == Interpolation::nearest)
    return first_order ? CostModel{0, 950, 0.0725, 30} : CostModel{0, 659, 0.0668, 30};
  return first_order ? CostModel{0, 1470, 0.0634, 30} : CostModel{0, 1290, 0.0582, 30};
}
CostModel pyramid_cost(bool first_order) {
  return first_order ? CostModel{621, 0, 15.1, 225} : CostModel{799, 0, 3.86, 225};
}

}  // namespace mica::host
