#include "host/methods/grid/grid_brdf.h"

#include <tbb/parallel_for.h>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "host/device/launch.h"
#include "host/methods/grid/grid_settings.h"
#include "host/microfacet/glint_masking.h"
#include "host/microfacet/horizon.h"

namespace mica::host {
namespace {

bool is_above(const Eigen::Vector3d& direction) {
  return direction.z() >= kMinCosine;
}

}  // namespace

GlintGrid grid_of(const GlintsDescription& glints) {
  GlintGrid grid;
  grid.distribution = glints.distribution;
  grid.alpha_x = glints.alpha.x(), grid.alpha_y = glints.alpha.y();
  grid.density = glints.density;
  grid.stretch = glints.stretch;
  grid.seed = glints.seed;
  return grid;
}

GridBrdf::GridBrdf(Device& device, const GlintsDescription& glints, std::size_t batch_queries)
    : device_(device),
      glints_(glints),
      point_(grid_of(glints).point()),
      batch_queries_(batch_queries),
      densities_(device, grid_of(glints), std::nullopt, batch_queries, glint_features(glints)) {
  const std::string options = grid_kernel_options(glints.distribution, draw_features(glints));
  draw_ = device.kernel("grid/grid_brdf.cl", "grid_draw", options, device.wave_form());
  draw_density_ = device.kernel("grid/grid_brdf.cl", "grid_draw_density", options, device.wave_form());
}

std::vector<std::vector<float>> GridBrdf::run(cl::Kernel* kernel, const GridBatch& batch, std::size_t count,
                                              std::size_t rows) {
  std::vector<std::vector<float>> result(rows, std::vector<float>(count));
  const cl::Buffer fields = device_.upload(batch.fields, "a batch of queries");
  const std::size_t row_bytes = batch.pitch * sizeof(float);
  const cl::Buffer out = device_.buffer(rows * row_bytes, CL_MEM_WRITE_ONLY, "results of a batch");
  reporting("running grid_brdf", [&] {
    const cl::Event done =
        launch(device_, *kernel, launch_size(device_.wave_form(), batch.pitch / kWaveLanes), fields,
               static_cast<cl_int>(batch.pitch), out);
    for (std::size_t row = 0; row < rows; ++row)
      device_.queue().enqueueReadBuffer(out, CL_TRUE, row * row_bytes, count * sizeof(float),
                                        result[row].data());
    device_seconds_ += seconds_of(done);
  });
  return result;
}

std::vector<float> GridBrdf::draw_densities(const std::vector<Query>& queries,
                                            const std::vector<GlintPoint>& points) {
  std::vector<float> densities;
  for (std::size_t first = 0; first < queries.size(); first += batch_queries_) {
    const std::size_t count = std::min(batch_queries_, queries.size() - first);
    const std::vector<float> batch =
        run(&draw_density_, to_grid_batch(queries, first, count, points), count, 1).front();
    densities.insert(densities.end(), batch.begin(), batch.end());
  }
  return densities;
}

/// The sum of the colours of the glints that mirror a query, each times what it adds to D.
Eigen::Vector3f GridBrdf::tint(const PendingDensities& densities, std::size_t query) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t color = 0; color < glints_.colors.size(); ++color)
    sum += glints_.colors[color] * static_cast<double>(densities.density_of_color(color, query));
  return sum.cast<float>();
}

std::vector<BrdfValue> GridBrdf::evaluate(const std::vector<BrdfQuery>& queries) {
  std::vector<BrdfValue> values(queries.size());
  std::vector<std::size_t> places;
  std::vector<Query> seen;
  std::vector<GlintPoint> points;
  for (std::size_t n = 0; n < queries.size(); ++n) {
    if (!is_above(queries[n].view) || !is_above(queries[n].light)) continue;
    const Eigen::Vector3d half = (queries[n].view + queries[n].light).normalized();
    places.push_back(n);
    seen.push_back({queries[n].footprint, half.head<2>(), queries[n].roughness});
    points.push_back(queries[n].glints.value_or(point_));
  }
  if (places.empty()) return values;
  const std::unique_ptr<PendingDensities> pending = densities_.start_at(seen, points);
  const std::vector<float> densities = pending->wait(), drawn = draw_densities(seen, points);
  tbb::parallel_for(std::size_t{0}, places.size(), [&](std::size_t n) {
    const BrdfQuery& query = queries[places[n]];
    const Eigen::Vector3d half = (query.view + query.light).normalized();
    const double G = glint_masking(glints_.distribution, glints_.masking,
                                   {points[n].alpha_x, points[n].alpha_y}, query.view, query.light);
    BrdfValue& value = values[places[n]];
    value.single = static_cast<float>(densities[n] * G / (4 * query.view.z()));  // [Kem25] Eq. 1, times i.g
    value.pdf = static_cast<float>(drawn[n] * half.z() / (4 * query.view.dot(half)));  // of h, then of i
    if (!glints_.colors.empty() && densities[n] > 0) value.tint = tint(*pending, n) / densities[n];
  });
  return values;
}

std::vector<Eigen::Vector2d> GridBrdf::draw(const std::vector<SampleQuery>& queries) {
  std::vector<Query> seen;
  std::vector<GlintPoint> points;
  for (const SampleQuery& query : queries) {
    seen.push_back({query.from.footprint, Eigen::Vector2d::Zero(), query.from.roughness});
    points.push_back(query.from.glints.value_or(point_));
  }
  std::vector<Eigen::Vector2d> half_vectors;
  for (std::size_t first = 0; first < queries.size(); first += batch_queries_) {
    const std::size_t count = std::min(batch_queries_, queries.size() - first);
    GridBatch batch = to_grid_batch(seen, first, count, points);
    for (std::size_t n = 0; n < count; ++n) {
      const std::uint64_t key = queries[first + n].key;
      batch.fields[device_types::MICA_GLINT_HALF_S * batch.pitch + n] =
          static_cast<std::int32_t>(static_cast<std::uint32_t>(key));
      batch.fields[device_types::MICA_GLINT_HALF_T * batch.pitch + n] =
          static_cast<std::int32_t>(static_cast<std::uint32_t>(key >> 32));
    }
    const std::vector<std::vector<float>> rows = run(&draw_, batch, count, 2);
    for (std::size_t n = 0; n < count; ++n) half_vectors.emplace_back(rows[0][n], rows[1][n]);
  }
  return half_vectors;
}

std::vector<BrdfSample> GridBrdf::sample(const std::vector<SampleQuery>& queries) {
  const std::vector<Eigen::Vector2d> half_vectors = draw(queries);
  std::vector<BrdfQuery> lit;
  std::vector<std::size_t> places;
  for (std::size_t n = 0; n < queries.size(); ++n) {
    const double z2 = 1 - half_vectors[n].squaredNorm();
    const ViewQuery& from = queries[n].from;
    if (z2 < 0 || !is_above(from.view)) continue;
    const Eigen::Vector3d half(half_vectors[n].x(), half_vectors[n].y(), std::sqrt(z2));
    const Eigen::Vector3d light = (2 * from.view.dot(half) * half - from.view).normalized();
    if (!is_above(light)) continue;
    places.push_back(n);
    lit.push_back({from.footprint, from.view, light, from.roughness, from.glints});
  }
  std::vector<BrdfSample> samples(queries.size());
  const std::vector<BrdfValue> values = evaluate(lit);
  for (std::size_t n = 0; n < places.size(); ++n) {
    if (!(values[n].pdf > 0)) continue;
    BrdfSample& sample = samples[places[n]];
    sample.light = lit[n].light.cast<float>();
    sample.pdf = values[n].pdf;
    sample.weight_single = values[n].single / values[n].pdf;
    sample.tint = values[n].tint;
  }
  return samples;
}

std::vector<Albedo> GridBrdf::energy(const std::vector<ViewQuery>& queries) {
  std::vector<Albedo> albedos(queries.size());
  const std::size_t views_a_batch = std::max<std::size_t>(batch_queries_ / kAlbedoDraws, 1);
  for (std::size_t first = 0; first < queries.size(); first += views_a_batch) {
    const std::size_t count = std::min(views_a_batch, queries.size() - first);
    std::vector<SampleQuery> draws;
    for (std::size_t n = 0; n < count; ++n)
      for (std::uint64_t key = 0; key < kAlbedoDraws; ++key) draws.push_back({queries[first + n], key});
    const std::vector<BrdfSample> samples = sample(draws);
    for (std::size_t n = 0; n < count; ++n) {
      double sum = 0;
      for (std::size_t draw = 0; draw < kAlbedoDraws; ++draw)
        sum += samples[n * kAlbedoDraws + draw].weight_single;
      albedos[first + n].single = static_cast<float>(sum / kAlbedoDraws);
      albedos[first + n].lost = static_cast<float>(std::max(1 - sum / kAlbedoDraws, 0.0));
    }
  }
  return albedos;
}

}  // namespace mica::host
