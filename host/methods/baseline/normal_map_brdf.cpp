#include "host/methods/baseline/normal_map_brdf.h"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "host/base/constants.h"
#include "host/base/random.h"
#include "host/microfacet/horizon.h"
#include "host/microfacet/low_discrepancy.h"
#include "host/microfacet/masking.h"
#include "host/microfacet/visible_normals.h"
#include "host/surface/interpolate.h"

namespace mica::host {
namespace {

bool above_horizon(const Eigen::Vector3d& direction) {
  return direction.z() >= kMinCosine;
}

/// Normals of the lobe about n' that directions are drawn from.
VisibleNormals lobe_of(double roughness) {
  return VisibleNormals(roughness * roughness * Eigen::Matrix2d::Identity());
}

}  // namespace

NormalMapBrdf::NormalMapBrdf(const Surface& surface) : surface_(surface) {}

/// Rows: n' as z, and x along +u as far as it can be.
Eigen::Matrix3d NormalMapBrdf::to_shading_frame(const Footprint& footprint) const {
  const Eigen::Vector2d uv = footprint.mean_uv - footprint.mean_uv.array().floor().matrix();
  const Eigen::Vector2d size(surface_.width(), surface_.height());
  const Eigen::Vector2d s = normal_at(surface_, uv.cwiseProduct(size));
  Eigen::Matrix3d rows;
  const Eigen::Vector3d z(s.x(), s.y(), std::sqrt(std::max(0.0, 1 - s.squaredNorm())));
  const Eigen::Vector3d x = (Eigen::Vector3d::UnitX() - z.x() * z).normalized();
  rows << x.transpose(), z.cross(x).transpose(), z.transpose();
  return rows;
}

BrdfValue NormalMapBrdf::value(const BrdfQuery& query) const {
  if (!above_horizon(query.view) || !above_horizon(query.light)) return {};
  const Eigen::Matrix3d to_shading = to_shading_frame(query.footprint);
  const Eigen::Vector3d view = to_shading * query.view, light = to_shading * query.light;
  if (!above_horizon(view) || !above_horizon(light)) return {};
  const Eigen::Vector3d half = (view + light).normalized();
  const double alpha = std::sqrt(2.0) * query.roughness, cos2 = half.z() * half.z();
  const double D =
      std::exp((1 - 1 / cos2) / (alpha * alpha)) / (kPi * alpha * alpha * cos2 * cos2);  // Beckmann
  const double G = smith_masking_shadowing(view.z(), light.z(), alpha);
  return {static_cast<float>(D * G / (4 * view.z())), 0,
          static_cast<float>(lobe_of(query.roughness).pdf(view, half))};
}

std::vector<BrdfValue> NormalMapBrdf::evaluate(const std::vector<BrdfQuery>& queries) {
  std::vector<BrdfValue> values(queries.size());
  tbb::parallel_for(std::size_t{0}, queries.size(), [&](std::size_t n) { values[n] = value(queries[n]); });
  return values;
}

BrdfSample NormalMapBrdf::draw(const ViewQuery& from, const Eigen::Vector2d& uniform) const {
  const Eigen::Matrix3d to_shading = to_shading_frame(from.footprint);
  const Eigen::Vector3d view = to_shading * from.view;
  if (!above_horizon(from.view) || !above_horizon(view)) return {};
  const Eigen::Vector3d half = lobe_of(from.roughness).sample(view, uniform);
  const Eigen::Vector3d light = to_shading.transpose() * (2 * half.dot(view) * half - view).normalized();
  const BrdfValue found = value({from.footprint, from.view, light, from.roughness});
  if (!(found.pdf > 0)) return {};
  return {light.cast<float>(), found.pdf, found.single / found.pdf, 0};
}

std::vector<BrdfSample> NormalMapBrdf::sample(const std::vector<SampleQuery>& queries) {
  std::vector<BrdfSample> samples(queries.size());
  tbb::parallel_for(std::size_t{0}, queries.size(), [&](std::size_t n) {
    const std::uint64_t key = queries[n].key;
    samples[n] = draw(queries[n].from, {random_unit(key, 0, 0), random_unit(key, 1, 0)});
  });
  return samples;
}

std::vector<Albedo> NormalMapBrdf::energy(const std::vector<ViewQuery>& queries) {
  constexpr std::uint32_t draws = 1024;
  std::vector<Albedo> albedos(queries.size());
  tbb::parallel_for(std::size_t{0}, queries.size(), [&](std::size_t n) {
    double sum = 0;
    for (std::uint32_t k = 0; k < draws; ++k)
      sum += static_cast<double>(draw(queries[n], low_discrepancy_point(k, 0)).weight_single);
    const double single = sum / draws;
    albedos[n] = {static_cast<float>(single), static_cast<float>(std::max(0.0, 1 - single))};
  });
  return albedos;
}

}  // namespace mica::host
