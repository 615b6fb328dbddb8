#include "host/methods/beckmanns/beckmann_brdf.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <array>
#include <cmath>

#include "host/base/constants.h"
#include "host/base/random.h"
#include "host/base/stopwatch.h"
#include "host/methods/gaussians/mixture_evaluator.h"
#include "host/methods/map/map_query.h"
#include "host/microfacet/masking.h"
#include "host/surface/disk.h"
#include "mica/error.h"

namespace mica::host {
namespace {

constexpr std::size_t kBatchQueries = 1 << 17;
constexpr std::size_t kAnswers = 4;   // floats a query of beckmann_patches.cl
constexpr int kAlbedoSamples = 1024;  // a view; quasi-random

/// Least product of two areas that is divided by: smaller ones are seen of nothing.
constexpr double kLeastAreas = 1e-12;

Eigen::Vector3d half_vector(const BrdfQuery& query) {
  return (query.view + query.light).normalized();
}

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
    const double place = random_unit(key, k, 0) + steps[k] * n;
    uniforms[k] = place - std::floor(place);
  }
  return uniforms;
}

}  // namespace

BeckmannBrdf::BeckmannBrdf(Device& device, const Surface& surface, const BeckmannBrdfSettings& settings)
    : masking_(settings.masking),
      lobes_(build_lobes(surface, settings.elements)),
      grid_{lobes_.grid, lobes_.slope_unit, lobes_.spread_unit, surface.interpolation(), settings.elements},
      sampler_(lobes_, grid_),
      squared_slope_(mean_squared_slope(surface)),
      cutoff_(cutoff_for(MixtureSettings().cutoff_error)) {
  std::vector<cl::Buffer> buffers = {device.upload(lobes_.lobes, "the map's lobes"),
                                     device.upload(lobes_.block_nodes, "the map's bounds"),
                                     device.upload(lobes_.tile_nodes, "the map's bounds")};
  device_bytes_ = lobes_.bytes();
  const WaveForm wave_form = settings.wave_form.value_or(device.wave_form());
  if (masking_ == Masking::geometric)
    densities_.emplace(device, lobes_.grid, buffers, device_bytes_, "beckmanns/beckmanns",
                       "-DMICA_COUNT_ELEMENTS=0", wave_form, kBatchQueries);
  const bool bounded = settings.energy_bound == EnergyBound::patch && masking_ != Masking::exact;
  if (masking_ != Masking::geometric || bounded) {
    const SlopePyramid pyramid = build_slope_pyramid(lobes_, false);
    levels_ = pyramid.levels;
    device_bytes_ += pyramid.bytes();
    buffers.push_back(device.upload(pyramid.numbers, "the pyramid of slopes"));
    const auto make = [&](Masking masking, std::optional<Patches>* patches) {
      patches->emplace(device, lobes_.grid, buffers, device_bytes_, "beckmanns/beckmann_patches",
                       fmt::format("-DMICA_MASKING={}", masking == Masking::exact ? 2 : 1), wave_form,
                       kBatchQueries, kAnswers);
    };
    if (masking_ != Masking::geometric) make(masking_, &patches_);
    if (bounded) make(Masking::exact, &bound_);
  }
  build_seconds_ = watch_.seconds();
}

double BeckmannBrdf::device_seconds() const {
  return (densities_ ? densities_->device_seconds() : patches_->device_seconds()) +
         (bound_ ? bound_->device_seconds() : 0);
}

std::vector<BeckmannBrdf::Parts> BeckmannBrdf::geometric_parts(const std::vector<BrdfQuery>& queries) {
  std::vector<device_types::mica_lobe_query> lobe_queries(queries.size());
  tbb::parallel_for(std::size_t{0}, queries.size(), [&](std::size_t n) {
    const BrdfQuery& query = queries[n];
    lobe_queries[n] = to_lobe_query({query.footprint, half_vector(query).head<2>(), query.roughness},
                                    lobe_weights(query.footprint, grid_), grid_, cutoff_);
  });
  const std::vector<float> densities = densities_->start(std::move(lobe_queries))->wait();
  std::vector<Parts> parts(queries.size());
  tbb::parallel_for(std::size_t{0}, queries.size(), [&](std::size_t n) {
    const double alpha = std::sqrt(squared_slope_ + 2 * queries[n].roughness * queries[n].roughness);
    const auto area = [&](double cosine) { return cosine * (1 + beckmann_lambda(cosine, alpha)); };
    parts[n] = {densities[n], area(queries[n].view.z()), area(queries[n].light.z()), queries[n].light.z()};
  });
  return parts;
}

std::vector<BeckmannBrdf::Parts> BeckmannBrdf::patch_parts(const std::vector<BrdfQuery>& queries,
                                                           Masking masking, Patches* patches) {
  std::vector<device_types::mica_patch_query> patch_queries(queries.size());
  const double ripple = masking == Masking::exact ? kSmallRipple : kMiddleRipple;
  tbb::parallel_for(std::size_t{0}, queries.size(), [&](std::size_t n) {
    const BrdfQuery& query = queries[n];
    device_types::mica_patch_query& patch = patch_queries[n];
    const LobeWeights weights = lobe_weights(query.footprint, grid_);
    patch.lobe = to_lobe_query({query.footprint, half_vector(query).head<2>(), query.roughness}, weights,
                               grid_, cutoff_);
    patch.slopes = to_slope_footprint(weights, grid_.grid, levels_, ripple);
    const Eigen::Vector3f view = query.view.cast<float>(), light = query.light.cast<float>();
    patch.view_x = view.x(), patch.view_y = view.y(), patch.view_z = view.z();
    patch.light_x = light.x(), patch.light_y = light.y(), patch.light_z = light.z();
    patch.weight = static_cast<float>(1 / (2 * kPi * weights.sigma[0] * weights.sigma[1] * weights.sum));
  });
  const std::vector<float> answers = patches->start(std::move(patch_queries))->wait();
  std::vector<Parts> parts(queries.size());
  tbb::parallel_for(std::size_t{0}, queries.size(), [&](std::size_t n) {
    // The light's projected area is negative behind the mean normal: nothing is received there.
    parts[n] = {answers[kAnswers * n], answers[kAnswers * n + 1], answers[kAnswers * n + 2],
                std::max(answers[kAnswers * n + 3], 0.0f)};
  });
  return parts;
}

std::vector<BeckmannBrdf::Parts> BeckmannBrdf::parts(const std::vector<BrdfQuery>& queries) {
  std::vector<Parts> parts =
      masking_ == Masking::geometric ? geometric_parts(queries) : patch_parts(queries, masking_, &*patches_);
  if (!bound_) return parts;
  const std::vector<Parts> exact = patch_parts(queries, Masking::exact, &*bound_);
  for (std::size_t n = 0; n < parts.size(); ++n) {
    parts[n].view_area = std::max(parts[n].view_area, exact[n].view_area);
    parts[n].light_area = std::max(parts[n].light_area, exact[n].light_area);
  }
  return parts;
}

std::vector<BrdfValue> BeckmannBrdf::evaluate(const std::vector<BrdfQuery>& queries) {
  std::vector<std::size_t> places;
  std::vector<BrdfQuery> visible;
  for (std::size_t n = 0; n < queries.size(); ++n) {
    if (below_horizon(queries[n].view) || below_horizon(queries[n].light)) continue;
    places.push_back(n);
    visible.push_back(queries[n]);
  }
  const std::vector<Parts> all = parts(visible);
  std::vector<BrdfValue> values(queries.size());
  tbb::parallel_for(std::size_t{0}, places.size(), [&](std::size_t n) {
    const Eigen::Vector3d half = half_vector(visible[n]);
    const double areas = std::max(all[n].view_area * all[n].light_area, kLeastAreas);
    values[places[n]].single = static_cast<float>(all[n].density * all[n].light_projected / (4 * areas));
    values[places[n]].pdf = static_cast<float>(all[n].density * half.z() / (4 * visible[n].view.dot(half)));
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
    for (std::size_t k = 0; k < uniforms.size(); ++k) uniforms[k] = random_unit(queries[n].key, 2, k);
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

/// Drawn normals h have the density D(h) (h.g), so that the mean of <o, h> / (h.g) is I(o), and that times
/// A(i) / I(i), over I(o), what is scattered. With exact areas the first mean is known, and what is lost is
/// summed instead: it cannot be negative.
Albedo BeckmannBrdf::albedo(const ViewQuery& from) {
  std::vector<Eigen::Vector3d> normals(kAlbedoSamples);
  tbb::parallel_for(0, kAlbedoSamples, [&](int k) {
    normals[k] = sampler_.draw(from.footprint, from.roughness, even_uniforms(1, k), mix_bits(k));
  });
  std::vector<BrdfQuery> seen;
  std::vector<double> facing;
  double hidden_facing = 0;  // of normals that mirror light from below the horizon
  for (const Eigen::Vector3d& normal : normals) {
    const double cosine = from.view.dot(normal);
    if (cosine <= 0) continue;
    const Eigen::Vector3d light = mirrored(from.view, normal);
    if (below_horizon(light)) {
      hidden_facing += cosine / normal.z();
    } else {
      seen.push_back({from.footprint, from.view, light, from.roughness});
      facing.push_back(cosine / normal.z());
    }
  }
  if (seen.empty()) return {0, 1};
  const std::vector<Parts> all = parts(seen);
  const double scale = 1 / (kAlbedoSamples * std::max(all[0].view_area, kLeastAreas));
  double scattered = 0, lost = scale * hidden_facing;
  for (std::size_t n = 0; n < seen.size(); ++n) {
    const double g1 = all[n].light_projected / std::max(all[n].light_area, kLeastAreas);
    scattered += scale * facing[n] * g1;
    lost += scale * facing[n] * std::max(1 - g1, 0.0);
  }
  if (masking_ == Masking::exact) scattered = 1 - std::min(lost, 1.0);
  return {static_cast<float>(scattered), static_cast<float>(std::max(1 - scattered, 0.0))};
}

std::vector<Albedo> BeckmannBrdf::energy(const std::vector<ViewQuery>& queries) {
  std::vector<Albedo> albedos(queries.size());
  for (std::size_t n = 0; n < queries.size(); ++n)
    if (!below_horizon(queries[n].view)) albedos[n] = albedo(queries[n]);
  return albedos;
}

}  // namespace mica::host
