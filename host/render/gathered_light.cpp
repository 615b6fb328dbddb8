#include "host/render/gathered_light.h"

#include <limits>

#include "host/base/random.h"
#include "host/microfacet/horizon.h"
#include "host/microfacet/low_discrepancy.h"
#include "host/render/surface_light.h"
#include "host/scene/bounce_fresnel.h"
#include "host/scene/shading.h"

namespace mica::host {
namespace {

/// Independent random numbers of one point.
enum Stream : std::uint64_t {
  kLightScramble,
  kSmoothScramble,
  kSmoothLobe,
  kBrdfKey,
  kSmoothPath,
  kBrdfPath
};

}  // namespace

GatheredLight::GatheredLight(const GatheringContext& context, const LitPoint& point, std::uint64_t key)
    : context_(context),
      point_(point),
      layers_(context.scene.layers(point.material)),
      key_(key),
      view_(point.frame.to_local(point.to_eye)),
      crossing_(layers_, view_),
      smooth_(layers_),
      has_smooth_(point.process == 0 && !smooth_.is_black()) {}

bool GatheredLight::faces(const Eigen::Vector3d& world) const {
  return world.dot(point_.frame.z) >= kMinCosine && world.dot(point_.frame.face_normal) >= kMinCosine;
}

Color GatheredLight::tint(const Eigen::Vector3f& of_facets) const {
  return point_.tint.cwiseProduct(of_facets.cast<double>());
}

/// Of one draw in the mean over the point's.
double GatheredLight::share() const {
  return 1.0 / context_.image.samples;
}

/// The share of a draw in the environment's radiance; zero where the point does not see it.
Color GatheredLight::seen_radiance(const Eigen::Vector3d& world) const {
  if (!faces(world)) return Color::Zero();
  const Color radiance = context_.scene.environment().radiance(world);
  if (radiance.isZero(0) || context_.scene.geometry().occluded(point_.hit, world, kFar)) return Color::Zero();
  return share() * radiance;
}

/// What comes from a direction that the material drew with a density of `pdf`: from afar, weighted against
/// the draws towards the light, or from another surface.
Color GatheredLight::drawn_radiance(const Eigen::Vector3d& local, double pdf, std::uint64_t path) const {
  const Eigen::Vector3d world = point_.frame.to_world(local);
  const Color radiance = seen_radiance(world);
  const int bounces = context_.image.max_bounces - 1;
  if (radiance.isZero(0) && bounces > 0 && faces(world))
    return share() * surface_light(context_.scene, ray_from(point_.hit, world), bounces, path);
  return radiance * (pdf / (pdf + (uses_lights() ? context_.scene.environment().pdf(world) : 0)));
}

void GatheredLight::draw() {
  const auto samples = static_cast<std::uint32_t>(context_.image.samples);
  const bool shines = !context_.scene.environment().is_black();
  for (std::uint32_t n = 0; n < samples && shines && uses_lights(); ++n) draw_light(n);
  for (std::uint32_t n = 0; n < samples && uses_brdf() && has_smooth_; ++n) draw_smooth(n);
}

void GatheredLight::draw_light(std::uint32_t n) {
  const Environment& environment = context_.scene.environment();
  const std::uint64_t scramble = random_bits(key_, kLightScramble, 0);
  const Eigen::Vector3d world = environment.sample(low_discrepancy_point(n, scramble));
  const LightDraw draw{point_.frame.to_local(world), seen_radiance(world), environment.pdf(world)};
  if (draw.radiance.isZero(0) || !(draw.pdf > 0)) return;
  draws_.push_back(draw);
  if (!has_smooth_) return;
  const double pdf = draw.pdf + (uses_brdf() ? smooth_.pdf(view_, draw.local) : 0);
  sum_ += smooth_.value(view_, draw.local).cwiseProduct(draw.radiance) / pdf;
}

void GatheredLight::draw_smooth(std::uint32_t n) {
  const std::uint64_t scramble = random_bits(key_, kSmoothScramble, 0);
  const Eigen::Vector2d point = low_discrepancy_point(n, scramble);
  const double lobe = random_unit(key_, kSmoothLobe, n);
  const Eigen::Vector3d local = smooth_.sample(view_, {point.x(), point.y(), lobe});
  const double pdf = smooth_.pdf(view_, local);
  if (!(pdf > 0)) return;
  const Color radiance = drawn_radiance(local, pdf, random_bits(key_, kSmoothPath, n));
  sum_ += smooth_.value(view_, local).cwiseProduct(radiance) / pdf;
}

BrdfQuery GatheredLight::query(const LightDraw& draw) const {
  return {point_.footprint, crossing_.view_below(), crossing_.below(draw.local), point_.roughness,
          point_.glints};
}

SampleQuery GatheredLight::sample_query(std::size_t n) const {
  return {{point_.footprint, crossing_.view_below(), point_.roughness, point_.glints},
          random_bits(key_, kBrdfKey, n)};
}

void GatheredLight::add(const LightDraw& draw, const BrdfValue& value) {
  const BounceFresnel fresnel(layers_, crossing_.view_below(), crossing_.below(draw.local));
  const Color reflected = value.single * fresnel.single + value.multiple * fresnel.multiple;
  const double pdf = uses_brdf() ? value.pdf * crossing_.density_scale(draw.local) : 0;
  sum_ += tint(value.tint)
              .cwiseProduct(reflected)
              .cwiseProduct(draw.radiance)
              .cwiseProduct(crossing_.value_scale(draw.local)) /
          (draw.pdf + pdf);
}

void GatheredLight::add(const BrdfSample& sample, std::size_t n) {
  if (!(sample.pdf > 0)) return;
  const Eigen::Vector3d below = sample.light.cast<double>(), local = crossing_.above(below);
  if (local.z() < kMinCosine) return;
  const double density_scale = crossing_.density_scale(local);
  const Color radiance = drawn_radiance(local, sample.pdf * density_scale, random_bits(key_, kBrdfPath, n));
  if (radiance.isZero(0)) return;
  const BounceFresnel fresnel(layers_, crossing_.view_below(), below);
  const Color weight = sample.weight_single * fresnel.single + sample.weight_multiple * fresnel.multiple;
  sum_ += tint(sample.tint)
              .cwiseProduct(weight)
              .cwiseProduct(radiance)
              .cwiseProduct(crossing_.value_scale(local)) /
          density_scale;
}

}  // namespace mica::host
