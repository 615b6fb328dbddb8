#include "host/reference/cavity.h"

#include <tbb/parallel_for.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace mica::host::reference {
namespace {

double clamped_dot(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::max(a.dot(b), 0.0);
}

Eigen::Vector3d on_hemisphere(const Eigen::Vector2d& disk) {
  return {disk.x(), disk.y(), std::sqrt(1 - disk.squaredNorm())};
}

double gaussian(const Eigen::Vector2d& x, double sigma) {
  return std::exp(-0.5 * x.squaredNorm() / (sigma * sigma)) / (2 * M_PI * sigma * sigma);
}

}  // namespace

Cavity::Cavity(const Eigen::Vector2d& facet) : facet_(on_hemisphere(facet)), dual_(on_hemisphere(-facet)) {}

double Cavity::intersection_probability(const Eigen::Vector3d& o) const {
  const double facet_area = clamped_dot(o, facet_) / facet_.z(),
               dual_area = clamped_dot(o, dual_) / dual_.z();
  return facet_area / (facet_area + dual_area);
}

double Cavity::masking(const Eigen::Vector3d& o) const {
  if (!(o.z() > 0 && o.dot(facet_) > 0)) return 0;
  return std::min(1.0, 2 * o.z() * facet_.z() / (clamped_dot(o, facet_) + clamped_dot(o, dual_)));
}

double Cavity::facet_energy(const Eigen::Vector3d& o) const {
  if (o.dot(facet_) <= 0) return 0;
  const Eigen::Vector3d reflected = 2 * o.dot(facet_) * facet_ - o;
  return intersection_probability(o) * masking(reflected);
}

double Cavity::energy(const Eigen::Vector3d& o) const {
  return facet_energy(o) + swapped().facet_energy(o);
}

double mirrored(const Eigen::Vector3d& o, const Eigen::Vector3d& i, double facets) {
  if (!(o.z() > 0 && i.z() > 0)) return 0;
  const Eigen::Vector3d half = (o + i).normalized();
  const Cavity cavity(half.head<2>());
  // From normals on the disk to directions i: the disk is the hemisphere foreshortened by h.g, and a mirror
  // that turns by an angle turns its image by twice as much.
  const double density = facets * half.z() / (4 * o.dot(half));
  return density * cavity.intersection_probability(o) * cavity.masking(i);
}

double blurred_energy(const Eigen::Vector3d& o, const Eigen::Vector2d& facet, double roughness) {
  constexpr int steps = 96;  // each way; 5.5 standard deviations
  constexpr double step = 5.5 / steps;
  double sum = 0, weights = 0;
  for (int a = -steps; a <= steps; ++a) {
    for (int b = -steps; b <= steps; ++b) {
      const Eigen::Vector2d offset(a * step, b * step);
      const double weight = std::exp(-0.5 * offset.squaredNorm());
      weights += weight;
      const Eigen::Vector2d normal = facet + roughness * offset;
      if (normal.squaredNorm() < 1) sum += weight * Cavity(normal).energy(o);
    }
  }
  return sum / weights;
}

std::vector<CavityMixture::Seed> CavityMixture::seeds(const Footprint& footprint) const {
  constexpr double reach = 7;  // standard deviations
  const double h = 1.0 / per_texel_;
  const Eigen::DiagonalMatrix<double, 2> texels(surface_.width(), surface_.height());
  const Eigen::Matrix2d covariance = texels * footprint.cov_uv * texels +
                                     h * h / (8 * std::log(2.0)) * Eigen::Matrix2d::Identity();  // sigma_h^2
  const Eigen::Matrix2d precision = covariance.inverse();
  const bool constant_texels = surface_.interpolation() == Interpolation::nearest;
  const double first = constant_texels ? 0.5 * h : 0.5;  // the first seed's coordinates, in texels
  const Eigen::Vector2d mean = texels * footprint.mean_uv;
  const Eigen::Vector2d extent = reach * covariance.diagonal().cwiseSqrt();
  const auto low = [&](int axis) { return std::lround(std::floor((mean[axis] - extent[axis] - first) / h)); };
  const auto high = [&](int axis) { return std::lround(std::ceil((mean[axis] + extent[axis] - first) / h)); };
  std::vector<Seed> all;
  double sum = 0;
  for (long b = low(1); b <= high(1); ++b) {
    for (long a = low(0); a <= high(0); ++a) {
      const Eigen::Vector2d place(first + static_cast<double>(a) * h, first + static_cast<double>(b) * h);
      const Eigen::Vector2d offset = place - mean;
      const double weight = std::exp(-0.5 * offset.dot(precision * offset));
      sum += weight;
      if (weight < 1e-14) continue;
      // Texel (i, j) and where in it, or in the quad that begins at its centre.
      const Eigen::Vector2d from(place.x() - (constant_texels ? 0 : 0.5),
                                 place.y() - (constant_texels ? 0 : 0.5));
      const long i = std::lround(std::floor(from.x() + 1e-9)), j = std::lround(std::floor(from.y() + 1e-9));
      const double f = from.x() - static_cast<double>(i), g = from.y() - static_cast<double>(j);
      Eigen::Vector2d normal = surface_.texel(i, j);
      if (!constant_texels)
        normal = (1 - f) * ((1 - g) * surface_.texel(i, j) + g * surface_.texel(i, j + 1)) +
                 f * ((1 - g) * surface_.texel(i + 1, j) + g * surface_.texel(i + 1, j + 1));
      all.push_back({normal, weight});
    }
  }
  for (Seed& seed : all) seed.weight /= sum;
  return all;
}

double CavityMixture::single(const BrdfQuery& query) const {
  if (!(query.view.z() > 0 && query.light.z() > 0)) return 0;
  const Eigen::Vector2d half = (query.view + query.light).normalized().head<2>();
  double density = 0;
  for (const Seed& seed : seeds(query.footprint))
    density += seed.weight * (gaussian(half - seed.normal, query.roughness) +
                              gaussian(half + seed.normal, query.roughness));
  return mirrored(query.view, query.light, density);
}

std::vector<double> CavityMixture::single(const std::vector<BrdfQuery>& queries) const {
  std::vector<double> values(queries.size());
  tbb::parallel_for(std::size_t{0}, queries.size(), [&](std::size_t n) { values[n] = single(queries[n]); });
  return values;
}

double CavityMixture::energy(const ViewQuery& query) const {
  if (!(query.view.z() > 0)) return 0;
  const std::vector<Seed> all = seeds(query.footprint);
  std::vector<double> shares(all.size());
  tbb::parallel_for(std::size_t{0}, all.size(), [&](std::size_t n) {
    if (all[n].weight > 1e-7)
      shares[n] = all[n].weight * blurred_energy(query.view, all[n].normal, query.roughness);
  });
  double sum = 0;
  for (const double share : shares) sum += share;
  return sum;
}

}  // namespace mica::host::reference
