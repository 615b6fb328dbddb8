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
  if (elements == 1) return {358, 420, 1.55};
  if (elements == 2) return {162, 684, 1.22};
  return {186, 824, 1.12};
}
CostModel triangles_cost() {
  return {0, 742, 0.03};
}
CostModel pyramid_cost() {
  return {812, 0, 2.03};
}

}  // namespace mica
