#include "host/render/gathered_light.h"

#include <limits>

#include "host/base/constants.h"
#include "host/base/random.h"
#include "host/microfacet/horizon.h"
#include "host/microfacet/low_discrepancy.h"
#include "host/render/surface_light.h"
#include "host/scene/bounce_fresnel.h"
#include "host/scene/shading.h"

namespace mica::host {
namespace {

/// Independent random numbers of one pixel or point.
enum Stream : std::uint64_t {
  kLightScramble,
  kSmoothScramble,
  kSmoothLobeScramble,
  kPlaceScramble,
  kNormalScramble,
  kBrdfKey,
  kSmoothPath,
  kBrdfPath
};

/// Where the environment is this many times as bright as in the mean, directions are drawn towards it; the
/// rest is seen by draws of normals alone.
constexpr double kBright = 16;

}  // namespace

GatheredLight::GatheredLight(const GatheringContext& context, const LitPoint& point,
                             const NormalDraws* normals, const GatheringKeys& keys)
    : context_(context),
      point_(point),
      layers_(context.scene.layers(point.material)),
      normals_(normals),
      keys_(keys),
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

/// The number of draw `n` among all of the pixel's, which are even together.
std::uint32_t GatheredLight::place_in_pixel(std::uint32_t n) const {
  return point_.subpixel * static_cast<std::uint32_t>(context_.image.samples) + n;
}

/// Whether the BRDF is asked about directions in which the environment draws with that density.
bool GatheredLight::asks_about(double light_pdf) const {
  if (!normals_ || !uses_brdf()) return true;
  return uses_lights() && light_pdf * 4 * kPi > kBright;
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

/// The share of a draw in what other surfaces throw from a direction.
Color GatheredLight::bounced_radiance(const Eigen::Vector3d& world, std::uint64_t path) const {
  const int bounces = context_.image.max_bounces - 1;
  if (bounces <= 0 || !faces(world)) return Color::Zero();
  return share() * surface_light(context_.scene, ray_from(point_.hit, world), bounces, path);
}

/// What comes from a direction that the material drew with a density of `pdf`: from afar, weighted against
/// the draws towards the light, or from another surface.
Color GatheredLight::drawn_radiance(const Eigen::Vector3d& local, double pdf, std::uint64_t path) const {
  const Eigen::Vector3d world = point_.frame.to_world(local);
  const Color radiance = seen_radiance(world);
  if (radiance.isZero(0)) return bounced_radiance(world, path);
  return radiance * (pdf / (pdf + (uses_lights() ? context_.scene.environment().pdf(world) : 0)));
}

void GatheredLight::draw() {
  const auto samples = static_cast<std::uint32_t>(context_.image.samples);
  const bool shines = !context_.scene.environment().is_black();
  for (std::uint32_t n = 0; n < samples && shines && uses_lights(); ++n) draw_light(n);
  for (std::uint32_t n = 0; n < samples && uses_brdf() && has_smooth_; ++n) draw_smooth(n);
  for (std::uint32_t n = 0; n < samples && uses_brdf() && normals_; ++n) draw_normal(n);
}

void GatheredLight::draw_light(std::uint32_t n) {
  const Environment& environment = context_.scene.environment();
  const std::uint64_t scramble = random_bits(keys_.pixel, kLightScramble, 0);
  const Eigen::Vector3d world = environment.sample(low_discrepancy_point(place_in_pixel(n), scramble));
  const double light_pdf = environment.pdf(world);
  const bool asks = asks_about(light_pdf);
  if (!(light_pdf > 0) || !(asks || has_smooth_)) return;
  const LightDraw draw{point_.frame.to_local(world), seen_radiance(world), light_pdf};
  if (draw.radiance.isZero(0)) return;
  if (asks) draws_.push_back(draw);
  if (!has_smooth_) return;
  const double pdf = draw.pdf + (uses_brdf() ? smooth_.pdf(view_, draw.local) : 0);
  sum_ += smooth_.value(view_, draw.local).cwiseProduct(draw.radiance) / pdf;
}

void GatheredLight::draw_smooth(std::uint32_t n) {
  const Eigen::Vector4d uniform =
      low_discrepancy_point4(place_in_pixel(n), random_bits(keys_.pixel, kSmoothScramble, 0),
                             random_bits(keys_.pixel, kSmoothLobeScramble, 0));
  const Eigen::Vector3d local = smooth_.sample(view_, uniform.head<3>());
  const double pdf = smooth_.pdf(view_, local);
  if (!(pdf > 0)) return;
  const Color radiance = drawn_radiance(local, pdf, random_bits(keys_.point, kSmoothPath, n));
  sum_ += smooth_.value(view_, local).cwiseProduct(radiance) / pdf;
}

/// A direction that a normal mirrors. What it sees of the environment's bright parts waits for the answer, as
/// draws towards them do: both are weighted by the same sum of densities.
void GatheredLight::draw_normal(std::uint32_t n) {
  const Eigen::Vector4d uniform =
      low_discrepancy_point4(place_in_pixel(n), random_bits(keys_.pixel, kPlaceScramble, 0),
                             random_bits(keys_.pixel, kNormalScramble, 0));
  const NormalDraws::Drawn drawn = normals_->draw_normal(
      {point_.footprint, crossing_.view_below(), point_.roughness, point_.glints}, uniform);
  if (!(drawn.weight > 0)) return;
  const Eigen::Vector3d local = crossing_.above(drawn.light);
  if (local.z() < kMinCosine) return;
  const Eigen::Vector3d world = point_.frame.to_world(local);
  const double light_pdf = uses_lights() ? context_.scene.environment().pdf(world) : 0;
  Color radiance = seen_radiance(world);
  if (asks_about(light_pdf) && !radiance.isZero(0)) {
    draws_.push_back({local, radiance, light_pdf});
    return;
  }
  if (radiance.isZero(0)) radiance = bounced_radiance(world, random_bits(keys_.point, kBrdfPath, n));
  if (radiance.isZero(0)) return;
  const BounceFresnel fresnel(layers_, crossing_.view_below(), drawn.light);
  sum_ += tint(Eigen::Vector3f::Ones())
              .cwiseProduct(drawn.weight * fresnel.single)
              .cwiseProduct(radiance)
              .cwiseProduct(crossing_.value_scale(local)) /
          crossing_.density_scale(local);
}

/// With which the material draws a direction below its coat.
double GatheredLight::brdf_pdf(const LightDraw& draw, const BrdfValue& value) const {
  if (!normals_) return value.pdf;
  const double weight = normals_->normal_weight(query(draw));
  return weight > 0 ? value.single / weight : 0;
}

BrdfQuery GatheredLight::query(const LightDraw& draw) const {
  return {point_.footprint, crossing_.view_below(), crossing_.below(draw.local), point_.roughness,
          point_.glints};
}

SampleQuery GatheredLight::sample_query(std::size_t n) const {
  return {{point_.footprint, crossing_.view_below(), point_.roughness, point_.glints},
          random_bits(keys_.point, kBrdfKey, n)};
}

void GatheredLight::add(const LightDraw& draw, const BrdfValue& value) {
  const BounceFresnel fresnel(layers_, crossing_.view_below(), crossing_.below(draw.local));
  const Color reflected = value.single * fresnel.single + value.multiple * fresnel.multiple;
  const double pdf = uses_brdf() ? brdf_pdf(draw, value) * crossing_.density_scale(draw.local) : 0;
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
  const Color radiance =
      drawn_radiance(local, sample.pdf * density_scale, random_bits(keys_.point, kBrdfPath, n));
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
