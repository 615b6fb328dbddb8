#include "host/engine/beckmann_brdf.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <array>
#include <cmath>

#include "host/base/error.h"
#include "host/base/stopwatch.h"
#include "host/engine/map_query.h"
#include "host/scene/masking.h"
#include "host/surface/disk.h"
#include "host/surface/random.h"

namespace mica {
namespace {

constexpr std::size_t kBatchQueries = 1 << 17;
constexpr double kCutoffError = 1e-6;
constexpr int kAlbedoSamples = 1024;  // a view; quasi-random

/// Directions of which nothing is seen or lit.
bool below_horizon(const Eigen::Vector3d& direction) {
  return !(direction.z() > 0);
}

double mean_squared_slope(const Surface& surface) {
  double sum = 0;
  for (const Eigen::Vector2d& s : surface.normals()) sum += slope_from_disk(s).squaredNorm();
  return sum / static_cast<double>(surface.normals().size());
}

/// The light that a normal mirrors to the view; zero when the view does not see it or the light would come
/// from below.
Eigen::Vector3d mirrored(const Eigen::Vector3d& view, const Eigen::Vector3d& normal) {
  const double cosine = view.dot(normal);
  const Eigen::Vector3d light = 2 * cosine * normal - view;
  if (cosine <= 0 || below_horizon(light)) return Eigen::Vector3d::Zero();
  return light.normalized();
}

/// The n-th point of a sequence that fills the unit cube evenly, moved by `key`. Its steps are powers of the
/// root of x^5 = x + 1. Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018.
std::array<double, 4> even_uniforms(std::uint64_t key, int n) {
  constexpr std::array<double, 4> steps = {0.8566748838545029, 0.733891856627126, 0.6287067210378087,
                                           0.5385972572236101};
  std::array<double, 4> uniforms{};
  for (std::size_t k = 0; k < uniforms.size(); ++k) {
    const double place = synthesis::random_unit(key, k, 0) + steps[k] * n;
    uniforms[k] = place - std::floor(place);
  }
  return uniforms;
}

}  // namespace

BeckmannBrdf::BeckmannBrdf(Device& device, const Surface& surface, const PatchBrdfSettings& settings)
    : masking_(settings.masking),
      lobes_(build_lobes(surface, settings.elements)),
      grid_{lobes_.grid, lobes_.slope_unit, lobes_.spread_unit, surface.interpolation(), settings.elements},
      sampler_(lobes_, grid_),
      squared_slope_(mean_squared_slope(surface)),
      cutoff_(cutoff_for(kCutoffError)) {
  if (masking_ != Masking::geometric)
    throw UsageError("masking \"" + masking_names()[static_cast<int>(masking_)] +
                     "\" is not available in this version; geometric is");
  densities_.emplace(device, lobes_.grid,
                     std::vector<cl::Buffer>{device.upload(lobes_.lobes, "the map's lobes"),
                                             device.upload(lobes_.block_nodes, "the map's bounds"),
                                             device.upload(lobes_.tile_nodes, "the map's bounds")},
                     lobes_.bytes(), "beckmanns", "-DMICA_COUNT_ELEMENTS=0", device.wave_form(),
                     kBatchQueries);
}

BeckmannBrdf::Areas BeckmannBrdf::geometric_areas(const BrdfQuery& query) const {
  const double alpha = std::sqrt(squared_slope_ + 2 * query.roughness * query.roughness);
  const auto area = [&](double cosine) { return cosine * (1 + beckmann_lambda(cosine, alpha)); };
  return {area(query.view.z()), area(query.light.z())};
}

std::vector<BrdfValue> BeckmannBrdf::evaluate(const std::vector<BrdfQuery>& queries) {
  std::vector<std::size_t> places;  // of the queries that have both directions above the horizon
  for (std::size_t n = 0; n < queries.size(); ++n)
    if (!below_horizon(queries[n].view) && !below_horizon(queries[n].light)) places.push_back(n);
  std::vector<device_types::mica_lobe_query> lobe_queries(places.size());
  tbb::parallel_for(std::size_t{0}, places.size(), [&](std::size_t n) {
    const BrdfQuery& query = queries[places[n]];
    const Eigen::Vector3d half = (query.view + query.light).normalized();
    lobe_queries[n] = to_lobe_query({query.footprint, half.head<2>(), query.roughness}, grid_, cutoff_);
  });
  const std::vector<float> densities = densities_->start(std::move(lobe_queries))->wait();

  std::vector<BrdfValue> values(queries.size());
  tbb::parallel_for(std::size_t{0}, places.size(), [&](std::size_t n) {
    const BrdfQuery& query = queries[places[n]];
    const Eigen::Vector3d half = (query.view + query.light).normalized();
    const Areas areas = geometric_areas(query);
    const double density = densities[n];
    values[places[n]].single = static_cast<float>(density * query.light.z() / (4 * areas.view * areas.light));
    values[places[n]].pdf = static_cast<float>(density * half.z() / (4 * query.view.dot(half)));
  });
  return values;
}

std::vector<BrdfSample> BeckmannBrdf::sample(const std::vector<SampleQuery>& queries) {
  std::vector<BrdfQuery> drawn(queries.size());
  tbb::parallel_for(std::size_t{0}, queries.size(), [&](std::size_t n) {
    const ViewQuery& from = queries[n].from;
    drawn[n] = {from.footprint, from.view, Eigen::Vector3d::Zero(), from.roughness};
    if (below_horizon(from.view)) return;
    std::array<double, 4> uniforms{};
    for (std::size_t k = 0; k < uniforms.size(); ++k)
      uniforms[k] = synthesis::random_unit(queries[n].key, 2, k);
    drawn[n].light =
        mirrored(from.view, sampler_.draw(from.footprint, from.roughness, uniforms, queries[n].key));
  });
  const std::vector<BrdfValue> values = evaluate(drawn);
  std::vector<BrdfSample> samples(queries.size());
  for (std::size_t n = 0; n < queries.size(); ++n) {
    if (!(values[n].pdf > 0)) continue;
    samples[n].light = drawn[n].light.cast<float>();
    samples[n].pdf = values[n].pdf;
    samples[n].weight_single = values[n].single / values[n].pdf;
  }
  return samples;
}

std::vector<Albedo> BeckmannBrdf::energy(const std::vector<ViewQuery>& queries) {
  std::vector<Albedo> albedos(queries.size());
  std::vector<BrdfQuery> drawn(kAlbedoSamples);
  for (std::size_t n = 0; n < queries.size(); ++n) {
    const ViewQuery& from = queries[n];
    if (below_horizon(from.view)) continue;
    tbb::parallel_for(0, kAlbedoSamples, [&](int k) {
      const Eigen::Vector3d normal =
          sampler_.draw(from.footprint, from.roughness, even_uniforms(1, k), synthesis::mix(k));
      drawn[k] = {from.footprint, from.view, mirrored(from.view, normal), from.roughness};
    });
    double sum = 0;
    for (const BrdfValue& value : evaluate(drawn))
      if (value.pdf > 0) sum += value.single / value.pdf;
    albedos[n].single = static_cast<float>(sum / kAlbedoSamples);
    albedos[n].lost = std::max(1 - albedos[n].single, 0.0f);
  }
  return albedos;
}

}  // namespace mica
