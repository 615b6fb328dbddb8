#include "host/measure/point_samples.h"

#include <tbb/parallel_for.h>

#include <cmath>

#include "host/base/constants.h"
#include "host/base/random.h"
#include "host/base/symmetric_matrix.h"
#include "host/surface/interpolate.h"

namespace mica::host::bench {
namespace {

double point_sample_mean(const Surface& surface, const Query& query, std::int64_t samples, std::uint64_t seed,
                         std::size_t n) {
  const Eigen::Matrix2d factor = cholesky_factor(query.footprint.cov_uv);
  const Eigen::Vector2d texels(surface.width(), surface.height());
  const double k = 0.5 / (query.roughness * query.roughness);
  double sum = 0;
  for (std::int64_t sample = 0; sample < samples; ++sample) {
    // Box and Muller.
    const std::uint64_t index = static_cast<std::uint64_t>(2 * sample);
    const double radius = std::sqrt(-2 * std::log1p(-random_unit(seed, n, index)));
    const double angle = 2 * kPi * random_unit(seed, n, index + 1);
    Eigen::Vector2d uv =
        query.footprint.mean_uv + factor * (radius * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
    uv -= uv.array().floor().matrix();
    sum += std::exp(-k * (normal_at(surface, uv.cwiseProduct(texels)) - query.half_vector).squaredNorm());
  }
  return sum / static_cast<double>(samples) * k / kPi;
}

}  // namespace

std::vector<float> point_samples(const Surface& surface, const std::vector<Query>& queries,
                                 std::int64_t samples, std::uint64_t seed) {
  std::vector<float> densities(queries.size());
  tbb::parallel_for(std::size_t{0}, queries.size(), [&](std::size_t n) {
    densities[n] = static_cast<float>(point_sample_mean(surface, queries[n], samples, seed, n));
  });
  return densities;
}

}  // namespace mica::host::bench
