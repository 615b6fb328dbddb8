#include "host/measure/coherent.h"

#include <algorithm>
#include <cmath>

#include "host/base/error_norms.h"

namespace mica::host::bench {
namespace {}  // namespace

std::vector<Query> coherent_queries(const Surface& surface, double sigma_texels, double roughness) {
  std::vector<Query> queries(kBlockSide * kBlockSide);
  const double sigma_uv = sigma_texels / surface.width();
  for (int n = 0; n < kBlockSide * kBlockSide; ++n) {
    const int x = n % kBlockSide, y = n / kBlockSide;
    queries[n].footprint.mean_uv = {0.3 + x * sigma_uv, 0.4 + y * sigma_uv};
    queries[n].footprint.cov_uv = Eigen::Matrix2d::Identity() * sigma_uv * sigma_uv;
    queries[n].half_vector = {0.15 * x / kBlockSide, 0.05 - 0.1 * y / kBlockSide};
    queries[n].roughness = roughness;
  }
  return queries;
}

std::vector<Query> thinned(const std::vector<Query>& queries, std::size_t stride) {
  std::vector<Query> some;
  for (std::size_t n = 0; n < queries.size(); n += stride) some.push_back(queries[n]);
  return some;
}

Timing timing_of(std::vector<double> seconds) {
  std::sort(seconds.begin(), seconds.end());
  return {seconds[seconds.size() / 2], seconds.front(), seconds.back()};
}

double relative_l2(const std::vector<float>& densities,
                   const std::vector<reference::OracleResult>& references) {
  RelativeL2 error;
  for (std::size_t n = 0; n < references.size(); ++n) error.add(densities[n], references[n].density);
  return error.value();
}

}  // namespace mica::host::bench
