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
  if (elements == 1) return {366, 380, 0.88, 50};
  if (elements == 2) return {0, 909, 2.38, 100};
  return {0, 1140, 9.46, 300};
}
CostModel triangles_cost(Interpolation interpolation) {
  if (interpolation == Interpolation::nearest) return {0, 723, 0.0163, 20};
  return {0, 930, 0.0185, 20};
}
CostModel pyramid_cost() {
  return {628, 0, 1.16, 300};
}

}  // namespace mica
