#include "host/engine/cost_model.h"

#include "host/engine/map_query.h"
#include "kernels/types.h"

namespace mica {

double blocks_reached(const Query& query, int map_width, int map_height) {
  constexpr double reach = 4.3;  // of a mixture's cutoff, standard deviations
  const FootprintAxes axes = footprint_axes(without_needless_periods(query.footprint), map_width, map_height);
  const auto blocks = [](double sigma) { return 1 + 2 * reach * sigma / device_types::MICA_BLOCK; };
  return blocks(axes.sigma_major_texels) * blocks(axes.sigma_minor_texels);
}

CostModel gaussians_cost(int elements) {
  if (elements == 1) return {360, 568, 1.7};
  if (elements == 2) return {477, 675, 1.31};
  return {441, 763, 1.17};
}
CostModel triangles_cost() {
  return {0, 781, 0.0312};
}
CostModel pyramid_cost() {
  return {685, 0, 2.4};
}

}  // namespace mica
