#include "host/scene/viewer.h"

#include "host/base/symmetric_matrix.h"
#include "host/microfacet/horizon.h"
#include "host/scene/bounce_fresnel.h"
#include "host/scene/coat_crossing.h"
#include "host/scene/disk_cells.h"
#include "host/scene/footprint.h"
#include "host/scene/wrap.h"

namespace mica::host {
namespace {

/// A covariance of half vectors on a point's disk.
Eigen::Matrix2d on_disk(const TangentFrame& frame, const Eigen::Matrix3d& half_vector_cov) {
  Eigen::Matrix<double, 2, 3> axes;
  axes << frame.x.transpose(), frame.y.transpose();
  Eigen::Matrix2d cov = axes * half_vector_cov * axes.transpose();
  cov(1, 0) = cov(0, 1);
  return cov;
}

/// Covariance on the disk of a lobe that half vectors of some covariance widen; none where it is round.
std::optional<Eigen::Matrix2d> long_lobe(const Eigen::Vector2d& roughness_uv, const TangentFrame& frame,
                                         const Eigen::Matrix3d& half_vector_cov) {
  constexpr double round = 0.02;  // half the difference of both variances, of their mean
  Eigen::Matrix2d cov = on_disk(frame, half_vector_cov);
  cov.diagonal() += roughness_uv.cwiseAbs2();
  const double mean = cov.trace() / 2;
  const double difference = std::hypot(cov(0, 0) - mean, cov(0, 1));
  if (!(difference > round * mean && mean + difference < 1)) return std::nullopt;
  return cov;
}

}  // namespace

StaticScene::StaticScene(const SceneDescription& description)
    : geometry(description.shapes),
      background(description.background, &findings),
      environment(description.environments, &findings),
      shows_environment(description.background.is_environment),
      materials(description.materials),
      part_materials(materials_of_parts(description, geometry)),
      glints(description.materials.size()) {
  for (const auto& parts : part_materials)
    for (const std::uint32_t n : parts)
      if (materials[n].glints && !glints[n]) glints[n].emplace(materials[n]);
  for (std::size_t n = 0; n < materials.size() && description.shapes.empty(); ++n)
    if (materials[n].glints && materials[n].id) glints[n].emplace(materials[n]);
}

bool Viewer::is_above(const Illumination& incident, const SeenPoint& point) const {
  return incident.irradiance.maxCoeff() > 0 && incident.direction.dot(point.frame.z) >= kMinCosine &&
         incident.direction.dot(point.frame.face_normal) >= kMinCosine;
}

double Viewer::visible_share(const LightDescription& light, const SeenPoint& point,
                             const std::vector<Eigen::Vector2d>& shadow_rays) const {
  const std::size_t rays = has_extent(light) ? shadow_rays.size() : 1;
  const ShadowRays to_light(light, point.hit->position);
  std::vector<ShadowRay> above;
  above.reserve(rays);
  for (std::size_t n = 0; n < rays; ++n) {
    const ShadowRay ray = to_light.to(shadow_rays[n]);
    if (ray.direction.dot(point.frame.face_normal) >= kMinCosine) above.push_back(ray);
  }
  return static_cast<double>(shared->geometry.count_open(*point.hit, above)) / static_cast<double>(rays);
}

/// What of a lamp, or of a part of it, a share of which no shadow hides, is seen in a point.
SeenLamp Viewer::see(const Illumination& incident, double visible, const SeenPoint& point) const {
  SeenLamp lamp;
  lamp.incident = incident;
  if (!is_above(incident, point)) return lamp;
  const TangentFrame& frame = point.frame;
  lamp.is_above = true;
  lamp.visible = visible;
  lamp.incident.irradiance *= visible;
  lamp.seen = see_lobes((*layers)[point.material], frame.z, point.to_eye, lamp.incident);
  lamp.half_vector = frame.on_disk(lamp.seen.half_vector);
  const Color regained = (*layers)[point.material].regained(frame.to_local(lamp.seen.to_eye));
  lamp.seen.mirrored = lamp.seen.mirrored.cwiseProduct(regained);
  lamp.seen.glint_weight = lamp.seen.glint_weight.cwiseProduct(regained);
  Eigen::Vector2d roughness_uv = shared->materials[point.material].roughness_uv();
  if (const std::optional<GlintMaterial>& glints = shared->glints[point.material]) {
    roughness_uv.setConstant(glints->microroughness(point.hit->uv));
    lamp.seen.glint_weight = glints->weight(*point.hit, frame, lamp.seen);
    lamp.seen.roughness = glints->widened(roughness_uv.x(), lamp.seen);
  }
  lamp.lobe_cov = long_lobe(roughness_uv, frame, lamp.seen.half_vector_cov);
  lamp.weight_unshadowed = lamp.seen.glint_weight.dot(incident.irradiance);
  return lamp;
}

/// Radius of a lamp's image on the disk of the half vectors, in standard deviations of the narrowest lobe.
double Viewer::lobes_across(const SeenLamp& lamp, const SeenPoint& point) const {
  const MaterialDescription& material = shared->materials[point.material];
  return 2 * std::sqrt(principal_axes(on_disk(point.frame, lamp.seen.half_vector_cov)).eigenvalues[1]) /
         material.roughness_uv().minCoeff();
}

SeenPoint Viewer::look(double x, double y, const LampSampling& sampling) const {
  SeenPoint point;
  point.ray = camera.ray(x, y);
  point.hit = shared->geometry.intersect({point.ray.origin, point.ray.direction});
  if (!point.hit) {
    point.radiance = shared->far_radiance(point.ray.direction);
    return point;
  }
  const Hit& hit = *point.hit;
  point.material = shared->part_materials[hit.shape][hit.part];
  const Eigen::Vector2d& repeat = shared->materials[point.material].repeat;
  point.to_eye = -point.ray.direction.normalized();
  point.frame = tangent_frame(hit, point.to_eye);
  point.uv = hit.uv.cwiseProduct(repeat);
  point.duv = repeat.asDiagonal() * uv_differentials(point.ray, hit);
  point.faces_eye = point.frame.face_normal.dot(point.to_eye) >= kMinCosine;
  if (point.faces_eye) see_lamps(sampling, &point);
  return point;
}

void Viewer::see_lamps(const LampSampling& sampling, SeenPoint* point) const {
  for (std::size_t n = 0; n < lights.size(); ++n) {
    const Illumination whole = illuminate(lights[n], point->hit->position);
    const double visible =
        is_above(whole, *point) ? visible_share(lights[n], *point, sampling.shadow_rays) : 0;
    std::vector<SeenLamp> parts = {see(whole, visible, *point)};
    double missed = 0;
    if (parts[0].is_above && whole.variance > 0) {
      const double lobes = lobes_across(parts[0], *point);
      const int rings = sampling.parts.rings(lobes);
      missed = error_of_cells(lobes, rings);
      if (rings > 0) {
        parts.clear();
        for (const Illumination& part : illuminate_by_parts(lights[n], point->hit->position, whole, rings))
          parts.push_back(see(part, visible, *point));
      }
    }
    for (SeenLamp& lamp : parts) {
      lamp.light = static_cast<std::uint32_t>(n);
      lamp.missed = missed;
      if (lamp.visible > 0) point->radiance += lamp.seen.smooth.cwiseProduct(lamp.incident.irradiance);
      point->lamps.push_back(std::move(lamp));
    }
  }
}

LitBrdf Viewer::lit_brdf(const GlintQuery& query, const SeenPoint& point,
                         const Illumination& incident) const {
  LitBrdf lit;
  const Eigen::Vector3d light = point.frame.to_local(incident.direction);
  const LayeredMaterial& material = (*layers)[query.material];
  const CoatCrossing crossing(material, point.frame.to_local(point.to_eye));
  lit.query = {query.query.footprint, crossing.view_below(), crossing.below(light), query.query.roughness};
  lit.pixel = query.pixel, lit.sample = query.sample;
  lit.material = query.material;
  const Color irradiance = incident.irradiance.cwiseProduct(crossing.value_scale(light));
  const BounceFresnel fresnel(material, lit.query.view, lit.query.light);
  lit.weight_single = fresnel.single.cwiseProduct(irradiance).cast<float>();
  lit.weight_multiple = fresnel.multiple.cwiseProduct(irradiance).cast<float>();
  return lit;
}

void Viewer::gather(const SeenPoint& point, const std::vector<GlintPlace>& places, const SamplePlace& place,
                    std::vector<LitPoint>* points) const {
  const std::optional<GlintMaterial>& glints = shared->glints[point.material];
  for (const GlintPlace& here : places) {
    const auto process = static_cast<std::uint32_t>(&here - places.data());
    LitPoint lit{*point.hit,   point.frame,    point.to_eye,   here.footprint,     place.key,
                 place.sample, place.subpixel, point.material, here.microroughness};
    lit.frame.x = here.x, lit.frame.y = here.y;
    lit.process = process;
    if (glints) lit.tint = glints->tint(point.hit->uv), lit.glints = here.point;
    points->push_back(lit);
  }
}

void Viewer::ask(const SeenPoint& point, double sigma_pixels, const SamplePlace& place,
                 const std::vector<Eigen::Matrix2d>& turns, RowQueries* queries) const {
  const std::optional<GlintMaterial>& glints = shared->glints[point.material];
  const MaterialDescription& material = shared->materials[point.material];
  GlintQuery query;
  query.pixel = place.pixel, query.sample = place.sample;
  query.missed_by_footprint = place.missed;
  query.material = point.material;
  query.query.footprint = {wrap(point.uv), footprint_covariance(point.duv, sigma_pixels)};
  std::vector<GlintPlace> places = {
      {query.query.footprint, point.frame.x, point.frame.y, material.roughness, {}}};
  if (glints) places = glints->places(point.ray, *point.hit, point.frame, sigma_pixels);
  query.query.footprint = places.front().footprint;
  if (gathering.points) gather(point, places, place, &queries->points);

  for (std::size_t n = 0; n < point.lamps.size(); ++n) {
    const SeenLamp& lamp = point.lamps[n];
    const bool is_hidden = !(lamp.visible > 0);
    if (is_hidden && !(lamp.is_above && !place.asked_if_hidden.empty() && place.asked_if_hidden[lamp.light] &&
                       !gathering.patch_materials[point.material]))
      continue;
    query.pixel = is_hidden ? GlintQuery::kNone : place.pixel;
    query.hidden_weight = is_hidden ? static_cast<float>(lamp.weight_unshadowed / 3) : 0.0f;  // as if grey
    query.light = lamp.light;
    query.missed_by_lamp = static_cast<float>(lamp.missed);
    if (gathering.patch_materials[point.material]) {
      query.query.roughness = lamp.seen.roughness;
      queries->lit.push_back(lit_brdf(query, point, lamp.incident));
      continue;
    }
    query.weight = lamp.seen.glint_weight.cwiseProduct(lamp.incident.irradiance).cast<float>();
    if (!(query.weight.maxCoeff() > 0 || query.hidden_weight > 0)) continue;
    if (!turns.empty()) query.query.half_vector_turn = turns[n], query.query.lobe_cov = lamp.lobe_cov;
    for (const GlintPlace& here : places) {
      query.query.footprint = here.footprint;
      query.query.half_vector = {lamp.seen.half_vector.dot(here.x), lamp.seen.half_vector.dot(here.y)};
      query.query.roughness = lamp.seen.roughness;
      query.glints = here.point;
      queries->glints.push_back(query);
    }
  }
}

}  // namespace mica::host
