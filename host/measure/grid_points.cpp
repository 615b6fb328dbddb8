#include "host/measure/grid_points.h"

#include <fmt/format.h>

#include <cmath>

#include "host/measure/coherent.h"
#include "host/methods/grid/grid_evaluator.h"
#include "host/reference/glint_grid.h"

namespace mica::host::bench {
namespace {

constexpr double kDensity = 1e6, kMicroroughness = 0.02;

std::vector<Query> queries_of(double cells_a_footprint) {
  const double sigma_uv = cells_a_footprint / std::sqrt(kDensity);
  std::vector<Query> queries(kBlockSide * kBlockSide);
  for (int n = 0; n < kBlockSide * kBlockSide; ++n) {
    const int x = n % kBlockSide, y = n / kBlockSide;
    queries[n].footprint.mean_uv = {0.3 + x * sigma_uv, 0.4 + y * sigma_uv};
    queries[n].footprint.cov_uv = Eigen::Matrix2d::Identity() * sigma_uv * sigma_uv;
    queries[n].half_vector = {0.3 * x / kBlockSide, 0.1 - 0.2 * y / kBlockSide};
    queries[n].roughness = kMicroroughness;
  }
  return queries;
}

}  // namespace

std::vector<GridPoint> measure_grid(Device& device, const Effort& effort, const Progress& progress) {
  GlintGrid grid;
  grid.density = kDensity;
  reference::GlintProcess process;
  process.density = kDensity;
  GridEvaluator evaluator(device, grid);
  std::vector<GridPoint> points;
  for (const double cells : {0.25, 1.0, 4.0, 16.0, 64.0, 256.0, 1024.0}) {
    progress(fmt::format("grid, footprints of {} cells", cells));
    const std::vector<Query> queries = queries_of(cells), few = thinned(queries, 257);
    std::vector<double> references;
    for (const Query& query : few) references.push_back(process.density_of(query));
    points.push_back(
        {cells, measure_speed(&evaluator, queries, effort), errors_of(evaluator.evaluate(few), references)});
  }
  return points;
}

}  // namespace mica::host::bench
