#include "host/measure/thumbnails.h"

#include <fmt/format.h>

#include <cmath>

#include "host/reference/oracle.h"
#include "host/surface/texel_footprint.h"

namespace mica::host::bench {
namespace {

constexpr double kSigmaTexels = 8, kRoughness = 0.01;
constexpr double kThumbnailTolerance = 1e-5;  // a picture shows no more

/// Half vectors over a window that holds most of the normals under the footprint.
std::vector<Query> window_queries(const Surface& surface, int side, double* radius) {
  const Footprint footprint = make_footprint(surface, {0.37, 0.61}, kSigmaTexels, kSigmaTexels, 0);
  const Eigen::Vector2d mean_texels(0.37 * surface.width(), 0.61 * surface.height());
  constexpr int reach = static_cast<int>(2 * kSigmaTexels);
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double squares = 0, count = 0;
  for (int j = -reach; j <= reach; ++j) {
    for (int i = -reach; i <= reach; ++i) {
      const Eigen::Vector2d& n =
          surface.texel(std::lround(mean_texels.x()) + i, std::lround(mean_texels.y()) + j);
      sum += n, squares += n.squaredNorm(), count += 1;
    }
  }
  const Eigen::Vector2d centre = sum / count;
  *radius = 2 * std::sqrt(std::max(squares / count - centre.squaredNorm(), 0.0)) + 3 * kRoughness;
  std::vector<Query> queries;
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      const Eigen::Vector2d offset((2 * column + 1.0) / side - 1, 1 - (2 * row + 1.0) / side);
      queries.push_back({footprint, (centre + *radius * offset).cwiseMax(-1).cwiseMin(1), kRoughness});
    }
  }
  return queries;
}

}  // namespace

ThumbnailRow thumbnails(const std::string& name, const Surface& surface,
                        const std::vector<Prepared>& contenders, int side, const Progress& progress) {
  ThumbnailRow row{name, kSigmaTexels, kRoughness, 0, {}};
  const std::vector<Query> queries = window_queries(surface, side, &row.window);
  progress(fmt::format("P-NDF of {}", name));
  std::vector<double> references;
  Thumbnail reference{"reference", "reference", side, {}, 0};
  for (const reference::OracleResult& result :
       reference::Oracle(surface, kThumbnailTolerance).evaluate(queries)) {
    references.push_back(result.density);
    reference.densities.push_back(static_cast<float>(result.density));
  }
  row.thumbnails.push_back(std::move(reference));
  for (const Prepared& prepared : contenders) {
    if (!prepared.evaluator || is_on_curve(prepared.contender)) continue;  // the table says why
    Thumbnail thumbnail{prepared.contender.evaluator, prepared.contender.label, side, {}, 0};
    thumbnail.densities = prepared.evaluator->evaluate(queries);
    thumbnail.relative_l2 = errors_of(thumbnail.densities, references).relative_l2;
    row.thumbnails.push_back(std::move(thumbnail));
  }
  return row;
}

}  // namespace mica::host::bench
