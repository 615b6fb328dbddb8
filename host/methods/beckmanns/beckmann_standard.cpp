#include "host/methods/beckmanns/beckmann_standard.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "host/methods/gaussians/mixture_settings.h"

namespace mica::host {
namespace {

/// Largest range of slopes in 4 x 4 texels and one more on each side: what 16 bits of a lobe's mean span.
double leaf_slopes(const Surface& surface) {
  const auto slope = [&](long i, long j) {
    const Eigen::Vector2d& s = surface.texel(i, j);
    return Eigen::Vector2d(s / std::sqrt(1 - s.squaredNorm()));
  };
  double largest = 0;
  for (long j = 0; j < surface.height(); ++j) {
    for (long i = 0; i < surface.width(); ++i) {
      Eigen::Vector2d low = slope(i, j), high = low;
      for (long n = 0; n < 36; ++n) {
        const Eigen::Vector2d other = slope(i - 1 + n % 6, j - 1 + n / 6);
        low = low.cwiseMin(other), high = high.cwiseMax(other);
      }
      largest = std::max(largest, (high - low).maxCoeff());
    }
  }
  return largest;
}

}  // namespace

BeckmannStandard::BeckmannStandard(const Surface& surface, int elements)
    : mixture_(surface, elements), leaf_slopes_(leaf_slopes(surface)) {}

std::vector<double> BeckmannStandard::references(const std::vector<Query>& queries) const {
  std::vector<double> densities(queries.size());
  tbb::parallel_for(std::size_t{0}, queries.size(), [&](std::size_t n) {
    const Query query = without_far_periods(queries[n]);
    densities[n] = reference::BeckmannMixture::density(mixture_.lobes(query.footprint, query.roughness),
                                                       query.half_vector);
  });
  return densities;
}

Promise BeckmannStandard::promise(double roughness) const {
  return {3e-4 + quantised(roughness), kMixtureDrops};
}

std::string BeckmannStandard::limitation(const std::vector<std::vector<Query>>& probes, const Query&,
                                         double worst_error) const {
  constexpr double much = 0.01, steep = 0.5;
  double most_quantised = 0;
  for (const std::vector<Query>& probe : probes)
    most_quantised = std::max(most_quantised, quantised(probe.front().roughness));
  if (most_quantised > much)
    return fmt::format("16 bits hold a lobe's slope to {:.2g} roughnesses here: {:.3g} times the bound",
                       most_quantised, worst_error);
  if (leaf_slopes_ > steep)
    return fmt::format(
        "lobes are fitted by points that are exact where slopes are quadratic, and here "
        "they run over {:.2g} in a few texels: {:.3g} times the bound",
        leaf_slopes_, worst_error);
  return "";
}

double BeckmannStandard::quantised(double roughness) const {
  constexpr double flank = 4.3, half_unit = 0.5 / 65534;  // standard deviations, at a cutoff of 9e-5
  return flank * half_unit * leaf_slopes_ / roughness;
}

}  // namespace mica::host
