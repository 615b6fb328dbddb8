#include "host/methods/ndf_brdf.h"

#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "host/base/constants.h"
#include "host/base/random.h"
#include "host/microfacet/horizon.h"
#include "host/microfacet/masking.h"
#include "host/microfacet/visible_normals.h"
#include "host/surface/disk.h"
#include "host/surface/interpolate.h"

namespace mica::host {
namespace {

enum Stream : std::uint64_t { kChoice, kDirectionX, kDirectionY, kPositionX, kPositionY };

double random(const SampleQuery& query, Stream stream) {
  return random_unit(query.key, stream, 0);
}

/// Two independent standard normal numbers. [Box and Muller 1958]
Eigen::Vector2d gaussian_pair(double x, double y) {
  const double radius = std::sqrt(-2 * std::log1p(-x));
  return radius * Eigen::Vector2d(std::cos(2 * kPi * y), std::sin(2 * kPi * y));
}

Eigen::Vector3d cosine_direction(double x, double y) {
  const double radius = std::sqrt(x);
  return {radius * std::cos(2 * kPi * y), radius * std::sin(2 * kPi * y), std::sqrt(1 - x)};
}

bool above_horizon(const Eigen::Vector3d& view, const Eigen::Vector3d& light) {
  return view.z() >= kMinCosine && light.z() >= kMinCosine;
}

Eigen::Vector3d half_vector(const Eigen::Vector3d& view, const Eigen::Vector3d& light) {
  return (view + light).normalized();
}

}  // namespace

NdfBrdf::NdfBrdf(Evaluator& evaluator, const Surface& surface, Draws draws)
    : evaluator_(evaluator),
      surface_(surface),
      slope_moments_(Eigen::Matrix2d::Zero()),
      normal_share_(draws == Draws::surface_normals ? 0.6 : 0),
      lobe_share_(draws == Draws::surface_normals ? 0.3 : 0.9),
      cosine_share_(0.1) {
  for (const Eigen::Vector2d& s : surface.normals()) {
    const Eigen::Vector2d slope = slope_from_disk(s);
    slope_moments_ += slope * slope.transpose();
  }
  slope_moments_ /= static_cast<double>(surface.normals().size());
}

Eigen::Matrix2d NdfBrdf::lobe_moments(double roughness) const {
  return slope_moments_ + roughness * roughness * Eigen::Matrix2d::Identity();
}

double NdfBrdf::masking(const BrdfQuery& query) const {
  return smith_masking_shadowing(query.view.z(), query.light.z(),
                                 std::sqrt(lobe_moments(query.roughness).trace()));
}

BrdfValue NdfBrdf::value(const BrdfQuery& query, double density) const {
  if (!above_horizon(query.view, query.light)) return {};
  const Eigen::Vector3d half = half_vector(query.view, query.light);
  const Eigen::Matrix2d moments = lobe_moments(query.roughness);
  const double G = masking(query);
  const double per_normal = 1 / (4 * std::max(query.view.dot(half), 1e-12));  // d half / d light
  const double pdf = normal_share_ * density * half.z() * per_normal +
                     lobe_share_ * VisibleNormals(moments).pdf(query.view, half) +
                     cosine_share_ * query.light.z() / kPi;
  return {static_cast<float>(density * G / (4 * query.view.z())), 0, static_cast<float>(pdf)};
}

std::vector<BrdfValue> NdfBrdf::evaluate(const std::vector<BrdfQuery>& queries) {
  std::vector<Query> density_queries(queries.size());
  tbb::parallel_for(std::size_t{0}, queries.size(), [&](std::size_t n) {
    const BrdfQuery& query = queries[n];
    const bool sees = above_horizon(query.view, query.light);
    const Eigen::Vector3d half = sees ? half_vector(query.view, query.light) : Eigen::Vector3d::UnitZ();
    density_queries[n] = {query.footprint, half.head<2>(), query.roughness};
  });
  const std::vector<float> densities = evaluator_.evaluate(density_queries);
  std::vector<BrdfValue> values(queries.size());
  tbb::parallel_for(std::size_t{0}, queries.size(),
                    [&](std::size_t n) { values[n] = value(queries[n], densities[n]); });
  return values;
}

/// Zero where the roughness takes it out of the disk.
Eigen::Vector3d NdfBrdf::surface_normal(const ViewQuery& from, const Eigen::Vector4d& uniform) const {
  const Footprint& footprint = from.footprint;
  const Eigen::Vector2d normal_pair = gaussian_pair(uniform[0], uniform[1]);
  const Eigen::Matrix2d root = footprint.cov_uv.llt().matrixL();
  Eigen::Vector2d uv = footprint.mean_uv + root * normal_pair;
  uv -= uv.array().floor().matrix();
  const Eigen::Vector2d position = uv.cwiseProduct(Eigen::Vector2d(surface_.width(), surface_.height()));
  const Eigen::Vector2d s =
      normal_at(surface_, position) + from.roughness * gaussian_pair(uniform[2], uniform[3]);
  const double rest = 1 - s.squaredNorm();
  return rest > 0 ? Eigen::Vector3d(s.x(), s.y(), std::sqrt(rest)) : Eigen::Vector3d::Zero();
}

/// A direction towards the light, or one below the horizon where there is none.
Eigen::Vector3d NdfBrdf::draw(const SampleQuery& query) const {
  const Eigen::Vector3d& view = query.from.view;
  if (view.z() < kMinCosine) return -Eigen::Vector3d::UnitZ();
  const double choice = random(query, kChoice);
  if (choice < cosine_share_) return cosine_direction(random(query, kDirectionX), random(query, kDirectionY));
  const Eigen::Vector3d half =
      choice < cosine_share_ + lobe_share_
          ? VisibleNormals(lobe_moments(query.from.roughness))
                .sample(view, {random(query, kDirectionX), random(query, kDirectionY)})
          : surface_normal(query.from, {random(query, kPositionX), random(query, kPositionY),
                                        random(query, kDirectionX), random(query, kDirectionY)});
  if (half.dot(view) <= 0) return -Eigen::Vector3d::UnitZ();  // a normal that turns away
  return (2 * half.dot(view) * half - view).normalized();
}

std::vector<BrdfSample> NdfBrdf::sample(const std::vector<SampleQuery>& queries) {
  std::vector<BrdfQuery> drawn(queries.size());
  tbb::parallel_for(std::size_t{0}, queries.size(), [&](std::size_t n) {
    const ViewQuery& from = queries[n].from;
    drawn[n] = {from.footprint, from.view, draw(queries[n]), from.roughness};
  });
  const std::vector<BrdfValue> values = evaluate(drawn);
  std::vector<BrdfSample> samples(queries.size());
  for (std::size_t n = 0; n < samples.size(); ++n) {
    if (!(values[n].pdf > 0)) continue;
    samples[n] = {drawn[n].light.cast<float>(), values[n].pdf, values[n].single / values[n].pdf, 0};
  }
  return samples;
}

double NdfBrdf::normal_weight(const BrdfQuery& query) const {
  if (!above_horizon(query.view, query.light)) return 0;
  const Eigen::Vector3d half = half_vector(query.view, query.light);
  return masking(query) * std::max(query.view.dot(half), 0.0) / (query.view.z() * std::max(half.z(), 1e-12));
}

NormalDraws::Drawn NdfBrdf::draw_normal(const ViewQuery& from, const Eigen::Vector4d& uniform) const {
  const Eigen::Vector3d half = surface_normal(from, uniform);
  if (from.view.z() < kMinCosine || half.dot(from.view) <= 0) return {-Eigen::Vector3d::UnitZ(), 0};
  const Eigen::Vector3d light = (2 * half.dot(from.view) * half - from.view).normalized();
  return {light, normal_weight({from.footprint, from.view, light, from.roughness})};
}

std::vector<Albedo> NdfBrdf::energy(const std::vector<ViewQuery>& queries) {
  constexpr std::size_t draws = 1024;
  std::vector<Albedo> albedos(queries.size());
  for (std::size_t n = 0; n < queries.size(); ++n) {
    std::vector<SampleQuery> samples(draws);
    for (std::size_t k = 0; k < draws; ++k) samples[k] = {queries[n], random_bits(0, 0, k)};
    double sum = 0;
    for (const BrdfSample& drawn : sample(samples)) sum += drawn.weight_single;
    const double single = sum / draws;
    albedos[n] = {static_cast<float>(single), static_cast<float>(std::max(0.0, 1 - single))};
  }
  return albedos;
}

}  // namespace mica::host
