// What a mixture of lobes stands for: the P-NDF of a bilinear normal map, by dense regular samples.
#pragma once

#include <tbb/parallel_for.h>

#include <Eigen/LU>
#include <cmath>
#include <vector>

#include "host/base/query.h"
#include "host/surface/surface.h"

namespace mica::host {

/// Half vectors on a lattice, a roughness apart, over the normals that the texels within two standard
/// deviations span.
inline std::vector<Query> lattice_queries(const Surface& surface, const Footprint& footprint,
                                          double roughness) {
  const Eigen::Array2d texels(surface.width(), surface.height());
  const Eigen::Array2d mean = footprint.mean_uv.array() * texels;
  const Eigen::Array2d reach = 2 * footprint.cov_uv.diagonal().array().sqrt() * texels;
  Eigen::Array2d low(1, 1), high(-1, -1);
  for (long j = std::lround(mean.y() - reach.y()); j <= std::lround(mean.y() + reach.y()); ++j) {
    for (long i = std::lround(mean.x() - reach.x()); i <= std::lround(mean.x() + reach.x()); ++i) {
      low = low.min(surface.texel(i, j).array());
      high = high.max(surface.texel(i, j).array());
    }
  }
  constexpr int most = 40;  // a side
  const Eigen::Array2d step = ((high - low) / most).max(roughness);
  std::vector<Query> queries;
  for (double t = low.y(); t <= high.y(); t += step.y())
    for (double s = low.x(); s <= high.x(); s += step.x()) queries.push_back({footprint, {s, t}, roughness});
  return queries;
}

/// D of queries of one footprint by midpoint samples of the bilinear patches, to about 1e-4.
inline std::vector<double> sample_bilinear(const Surface& surface, const std::vector<Query>& queries) {
  constexpr int samples = 24;    // a texel and axis
  constexpr double reach = 4.5;  // standard deviations
  const Footprint& footprint = queries.front().footprint;
  const Eigen::DiagonalMatrix<double, 2> texels(surface.width(), surface.height());
  const Eigen::Matrix2d cov = texels * footprint.cov_uv * texels;
  const Eigen::Vector2d mean = texels * footprint.mean_uv, extent = reach * cov.diagonal().cwiseSqrt();
  const Eigen::Matrix2d inverse = cov.inverse();
  struct Sample {
    double s, t, weight;
  };
  std::vector<Sample> drawn;
  double weights = 0;
  for (double y = mean.y() - extent.y(); y < mean.y() + extent.y(); y += 1.0 / samples) {
    for (double x = mean.x() - extent.x(); x < mean.x() + extent.x(); x += 1.0 / samples) {
      const Eigen::Vector2d offset = Eigen::Vector2d(x, y) - mean;
      const double weight = std::exp(-0.5 * offset.dot(inverse * offset));
      const long i = static_cast<long>(std::floor(x - 0.5)), j = static_cast<long>(std::floor(y - 0.5));
      const double f = x - 0.5 - static_cast<double>(i), g = y - 0.5 - static_cast<double>(j);
      const Eigen::Vector2d n = (1 - g) * ((1 - f) * surface.texel(i, j) + f * surface.texel(i + 1, j)) +
                                g * ((1 - f) * surface.texel(i, j + 1) + f * surface.texel(i + 1, j + 1));
      drawn.push_back({n.x(), n.y(), weight});
      weights += weight;
    }
  }
  std::vector<double> densities(queries.size());
  tbb::parallel_for(std::size_t{0}, queries.size(), [&](std::size_t n) {
    const Query& query = queries[n];
    const double k = 0.5 / (query.roughness * query.roughness);
    double sum = 0;
    for (const Sample& sample : drawn) {
      const double ds = sample.s - query.half_vector.x(), dt = sample.t - query.half_vector.y();
      const double exponent = k * (ds * ds + dt * dt);
      if (exponent < 18) sum += sample.weight * std::exp(-exponent);
    }
    densities[n] = sum / weights * k / M_PI;
  });
  return densities;
}

}  // namespace mica::host
