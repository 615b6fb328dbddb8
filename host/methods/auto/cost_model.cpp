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

CostModel gaussians_cost(int elements) {
  if (elements == 1) return {380, 221, 1.03, 70};
  if (elements == 2) return {0, 612, 2.64, 160};
  return {0, 820, 9.85, 530};
}
CostModel triangles_cost(Interpolation interpolation) {
  if (interpolation == Interpolation::nearest) return {0, 451, 0.0159, 20};
  return {0, 879, 0.0139, 20};
}
CostModel pyramid_cost() {
  return {365, 0, 1.42, 150};
}

}  // namespace mica::host
