#include "host/methods/cavities/cavity_brdf.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "host/base/random.h"
#include "host/base/stopwatch.h"
#include "host/methods/beckmanns/lobe_sampler.h"
#include "host/methods/map/map_query.h"
#include "mica/error.h"

namespace mica::host {
namespace {

using device_types::mica_cavity_query;
using device_types::mica_map_query;

bool same_view(const ViewQuery& a, const ViewQuery& b) {
  return a.view == b.view && a.roughness == b.roughness && a.footprint.mean_uv == b.footprint.mean_uv &&
         a.footprint.cov_uv == b.footprint.cov_uv;
}

mica_cavity_query as_cavity_query(const ViewQuery& query, const CavityGrid& cavities, double cutoff) {
  return to_cavity_query(query, cavities, cutoff);
}

ViewQuery view_of(const BrdfQuery& query) {
  return {query.footprint, query.view, query.roughness};
}

std::int32_t wrap(long index, long period) {
  const long remainder = index % period;
  return static_cast<std::int32_t>(remainder < 0 ? remainder + period : remainder);
}

}  // namespace

CavityBrdf::CavityBrdf(Device& device, const Surface& surface, const CavitySettings& settings)
    : compensation_(settings.compensation), cutoff_(cutoff_for(settings.cutoff_error)) {
  if (settings.per_texel != 1 && settings.per_texel != 2)
    throw UsageError(fmt::format("{} seeds a texel and axis; cavities takes 1 and 2 (spacing 1 and 0.5)",
                                 settings.per_texel));
  if (surface.interpolation() == Interpolation::bicubic && settings.per_texel != 1)
    throw UsageError("cavities takes bicubic maps with spacing 1 only, where they are not interpolated");
  const Stopwatch watch;
  const MapStructure map = build_map_structure(surface);
  cavities_ = {map.grid, surface.interpolation(), settings.per_texel, settings.compensation_width};
  build_seconds_ = watch.seconds();

  const std::string options =
      fmt::format("-DMICA_INTERPOLATION={} -DMICA_SEEDS={} -DMICA_COMPENSATION={} -DMICA_COUNT_ELEMENTS={}",
                  static_cast<int>(surface.interpolation()), settings.per_texel,
                  static_cast<int>(compensation_), static_cast<int>(settings.count_elements));
  const WaveForm form = settings.wave_form.value_or(device.wave_form());
  const std::vector<cl::Buffer> structure = {device.upload(map.normals, "the map's normals"),
                                             device.upload(map.block_nodes, "the map's bounds"),
                                             device.upload(map.tile_nodes, "the map's bounds")};
  bounces_.emplace(device, map.grid, structure, map.bytes(), "cavities/cavities", options, form,
                   settings.batch_queries);
  const std::vector<cl::Buffer> normals = {structure[0]};
  if (settings.energy == LostEnergy::sampled)
    sampled_energies_.emplace(device, map.grid, normals, 0, "cavities/cavity_samples", options, form,
                              settings.batch_queries);
  else
    energies_.emplace(device, map.grid, structure, 0, "cavities/cavity_energies", options, form,
                      settings.batch_queries);
  draws_.emplace(device, map.grid, normals, 0, "cavities/cavity_draws", options, form, settings.batch_queries,
                 3);
}

double CavityBrdf::device_seconds() const {
  return bounces_->device_seconds() + draws_->device_seconds() +
         (energies_ ? energies_->device_seconds() : sampled_energies_->device_seconds());
}

std::vector<BrdfValue> CavityBrdf::evaluate(const std::vector<BrdfQuery>& queries) {
  std::vector<mica_map_query> bounces(queries.size());
  std::vector<ViewQuery> views(queries.size());
  tbb::parallel_for(std::size_t{0}, queries.size(), [&](std::size_t n) {
    bounces[n] = to_cavity_query(queries[n], cavities_, cutoff_);
    views[n] = view_of(queries[n]);
  });
  const std::unique_ptr<PendingDensities> pending = bounces_->start(std::move(bounces));
  const std::vector<Albedo> albedos = energy(views);
  const std::vector<float> singles = pending->wait();
  std::vector<BrdfValue> values(queries.size());
  tbb::parallel_for(std::size_t{0}, queries.size(), [&](std::size_t n) {
    const BrdfQuery& query = queries[n];
    values[n].single = singles[n];
    values[n].multiple =
        static_cast<float>(albedos[n].lost * compensation(compensation_, query.view, query.light,
                                                          query.roughness, cavities_.compensation_width));
    values[n].pdf = values[n].single + values[n].multiple;
  });
  return values;
}

template <typename DeviceQuery, typename Translate>
std::vector<float> CavityBrdf::ask(MapBatches<DeviceQuery>* batches, const std::vector<ViewQuery>& queries,
                                   const std::vector<std::size_t>& asked, const Translate& translate) const {
  std::vector<DeviceQuery> views(asked.size());
  tbb::parallel_for(std::size_t{0}, asked.size(),
                    [&](std::size_t n) { views[n] = translate(queries[asked[n]], cavities_, cutoff_); });
  return batches->start(std::move(views))->wait();
}

std::vector<Albedo> CavityBrdf::energy(const std::vector<ViewQuery>& queries) {
  std::vector<Albedo> albedos(queries.size());
  // Lights that share a view come one after the other.
  std::vector<std::size_t> place(queries.size());
  std::vector<std::size_t> firsts;
  for (std::size_t n = 0; n < queries.size(); ++n) {
    if (n == 0 || !same_view(queries[n - 1], queries[n])) firsts.push_back(n);
    place[n] = firsts.size() - 1;
  }
  const std::vector<float> energies = sampled_energies_
                                          ? ask(&*sampled_energies_, queries, firsts, to_sampled_query)
                                          : ask(&*energies_, queries, firsts, as_cavity_query);
  for (std::size_t n = 0; n < queries.size(); ++n) {
    if (!(queries[n].view.z() > 0)) continue;
    albedos[n].single = std::min(energies[place[n]], 1.0f);
    albedos[n].lost = 1 - albedos[n].single;
  }
  return albedos;
}

std::vector<Eigen::Vector3d> CavityBrdf::draw(const std::vector<SampleQuery>& queries) {
  std::vector<mica_cavity_query> draws(queries.size());
  const long seeds_x = static_cast<long>(cavities_.grid.width) * cavities_.per_texel,
             seeds_y = static_cast<long>(cavities_.grid.height) * cavities_.per_texel;
  tbb::parallel_for(std::size_t{0}, queries.size(), [&](std::size_t n) {
    const SampleQuery& query = queries[n];
    draws[n] = to_cavity_query(query.from, cavities_, cutoff_);
    const SeedWeights weights = seed_weights(query.from.footprint, cavities_);
    const LatticePoint seed =
        pick_on_lattice(weights.mean_seeds, weights.cov_seeds,
                        {random_unit(query.key, 2, 0), random_unit(query.key, 2, 1)}, query.key);
    draws[n].seed_i = wrap(seed.i, seeds_x), draws[n].seed_j = wrap(seed.j, seeds_y);
    draws[n].key_low = static_cast<std::int32_t>(query.key);
    draws[n].key_high = static_cast<std::int32_t>(query.key >> 32);
  });
  const std::vector<float> directions = draws_->start(std::move(draws))->wait();
  std::vector<Eigen::Vector3d> lights(queries.size());
  for (std::size_t n = 0; n < queries.size(); ++n)
    lights[n] = Eigen::Vector3d(directions[3 * n], directions[3 * n + 1], directions[3 * n + 2]).normalized();
  return lights;
}

std::vector<BrdfSample> CavityBrdf::sample(const std::vector<SampleQuery>& queries) {
  const std::vector<Eigen::Vector3d> lights = draw(queries);
  std::vector<BrdfQuery> drawn(queries.size());
  for (std::size_t n = 0; n < queries.size(); ++n)
    drawn[n] = {queries[n].from.footprint, queries[n].from.view, lights[n], queries[n].from.roughness};
  const std::vector<BrdfValue> values = evaluate(drawn);
  std::vector<BrdfSample> samples(queries.size());
  for (std::size_t n = 0; n < queries.size(); ++n) {
    if (!(values[n].pdf > 0)) continue;
    samples[n].light = lights[n].cast<float>();
    samples[n].pdf = values[n].pdf;
    samples[n].weight_single = values[n].single / values[n].pdf;
    samples[n].weight_multiple = 1 - samples[n].weight_single;  // multiple / pdf, rounded to one in all
  }
  return samples;
}

}  // namespace mica::host
