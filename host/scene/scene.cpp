#include "host/scene/scene.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "host/base/random.h"
#include "host/microfacet/horizon.h"
#include "host/scene/background.h"
#include "host/scene/camera.h"
#include "host/scene/coat.h"
#include "host/scene/coat_crossing.h"
#include "host/scene/footprint.h"
#include "host/scene/geometry.h"
#include "host/scene/glint_material.h"
#include "host/scene/lobes.h"
#include "host/scene/part_materials.h"
#include "host/scene/shading.h"
#include "mica/error.h"

namespace mica::host {
namespace {

constexpr double kDefaultMaskingAlpha = 0.1;
constexpr double kFilterSigmaSubpixels = 0.5;

/// To [0, 1); of a tiny negative number, 1 - x would round to 1.
Eigen::Vector2d wrap(const Eigen::Vector2d& uv) {
  const Eigen::Vector2d wrapped = uv - uv.array().floor().matrix();
  return (wrapped.array() < 1).select(wrapped, 0);
}

struct IsUsableLight {
  bool operator()(const PointLight& light) const {
    return light.position.allFinite() && light.intensity.allFinite() && light.intensity.minCoeff() >= 0;
  }
  bool operator()(const DirectionalLight& light) const {
    return light.direction.allFinite() && light.direction.norm() > 0 && light.irradiance.allFinite() &&
           light.irradiance.minCoeff() >= 0;
  }
  bool operator()(const SphereLight& light) const {
    return (*this)(PointLight{light.position, light.intensity}) && std::isfinite(light.radius) &&
           light.radius >= 0;
  }
  bool operator()(const DiskLight& light) const {
    return (*this)(SphereLight{light.position, light.radius, light.intensity}) &&
           light.direction.allFinite() && light.direction.norm() > 0;
  }
};

/// What the rows of a block collect, each for itself.
struct RowQueries {
  std::vector<GlintQuery> glints;
  std::vector<LitPoint> points;
  std::vector<LitBrdf> lit;

  std::size_t size() const { return glints.size() + lit.size(); }
};

template <typename Item>
void join(std::vector<RowQueries>* rows, std::vector<Item> RowQueries::*part, std::vector<Item>* all) {
  std::size_t total = 0;
  for (const RowQueries& row : *rows) total += (row.*part).size();
  all->reserve(total);
  for (RowQueries& row : *rows) {
    all->insert(all->end(), (row.*part).begin(), (row.*part).end());
    std::vector<Item>().swap(row.*part);
  }
}

void check_lights(const std::vector<LightDescription>& lights) {
  for (std::size_t i = 0; i < lights.size(); ++i)
    if (!std::visit(IsUsableLight{}, lights[i]))
      throw UsageError(fmt::format("light {}: expected finite values and no negative power", i + 1));
}

void complete(std::vector<double>* masking_alpha, std::size_t materials) {
  for (const double alpha : *masking_alpha)
    if (!(alpha >= 0 && std::isfinite(alpha))) throw UsageError(fmt::format("masking alpha of {}", alpha));
  masking_alpha->resize(materials, kDefaultMaskingAlpha);
}

/// Where on a light the shadow ray of a subpixel ends: all subpixels of a pixel cover the light evenly, in an
/// order of the pixel's own, so that penumbras have no bands.
Eigen::Vector2d shadow_sample(std::uint64_t pixel, int subpixel, int subpixels) {
  const std::uint64_t hash = scramble_bits((pixel + 1) * kGoldenBits);
  const double step = 1.0 / subpixels, unit = 1.0 / 4294967296.0;
  const Eigen::Vector2d shift(unit * static_cast<double>(hash >> 32),
                              unit * static_cast<double>(hash & 0xffffffffu));
  return wrap(step * Eigen::Vector2d(subpixel % subpixels, subpixel / subpixels) + shift);
}

/// Sums of one pixel's AOVs over the subpixels that hit a shape.
class PixelMeans {
 public:
  void add(const Footprint& footprint, const Eigen::Vector3d& normal) {
    if (count_ == 0) first_uv_ = footprint.mean_uv;
    const Eigen::Vector2d step = footprint.mean_uv - first_uv_;
    uv_offset_ += step - step.array().round().matrix();  // the short way across the wrap
    covariance_ += Eigen::Vector3d(footprint.cov_uv(0, 0), footprint.cov_uv(0, 1), footprint.cov_uv(1, 1));
    normal_ += normal;
    ++count_;
  }
  void write(TracedRows* rows, std::size_t pixel) const {
    if (count_ == 0) return;
    const Eigen::Vector2f uv = wrap(first_uv_ + uv_offset_ / count_).cast<float>();
    rows->uv[pixel] = (uv.array() < 1).select(uv, 0);
    rows->footprint[pixel] = (covariance_ / count_).cast<float>();
    rows->normal[pixel] = (normal_ / count_).cast<float>();
  }

 private:
  int count_ = 0;
  Eigen::Vector2d first_uv_{0, 0}, uv_offset_{0, 0};
  Eigen::Vector3d covariance_{0, 0, 0}, normal_{0, 0, 0};
};

TracedRows empty_rows(int first_row, int row_count, int width) {
  TracedRows rows;
  rows.first_row = first_row, rows.row_count = row_count;
  const std::size_t pixels = static_cast<std::size_t>(row_count) * static_cast<std::size_t>(width);
  rows.radiance.assign(pixels, Eigen::Vector3f::Zero());
  rows.uv.assign(pixels, Eigen::Vector2f::Zero());
  rows.footprint.assign(pixels, Eigen::Vector3f::Zero());
  rows.normal.assign(pixels, Eigen::Vector3f::Zero());
  rows.query_count.assign(pixels, 0);
  return rows;
}

}  // namespace

namespace {

/// What does not change from frame to frame.
struct StaticScene {
  Geometry geometry;
  Background background;
  Environment environment;
  bool shows_environment;  ///< where rays hit nothing
  std::vector<MaterialDescription> materials;
  std::vector<std::optional<CoatInterface>> coats;  ///< one a material
  PartMaterials part_materials;
  std::vector<std::optional<GlintMaterial>> glints;  ///< one a material; only for those that a shape has
  Findings findings;

  Color far_radiance(const Eigen::Vector3d& direction) const {
    return shows_environment ? environment.radiance(direction) : background.radiance(direction);
  }
};

StaticScene make_static_scene(const SceneDescription& description) {
  Findings findings;
  StaticScene made{Geometry(description.shapes),
                   Background(description.background, &findings),
                   Environment(description.environments, &findings),
                   description.background.is_environment,
                   description.materials,
                   {},
                   {},
                   {},
                   {}};
  made.findings = std::move(findings);
  for (const MaterialDescription& material : description.materials)
    made.coats.push_back(material.coat ? std::optional<CoatInterface>(*material.coat) : std::nullopt);
  made.part_materials = materials_of_parts(description, made.geometry);
  made.glints.resize(description.materials.size());
  for (const auto& parts : made.part_materials)
    for (const std::uint32_t n : parts)
      if (description.materials[n].glints && !made.glints[n])
        made.glints[n].emplace(description.materials[n]);
  return made;
}

/// One of a pixel's footprints.
struct Subpixel {
  std::uint32_t pixel, index;    ///< as in LitPoint
  Eigen::Vector2d light_sample;  ///< where on a light shadow rays end, see light_ray
};

}  // namespace

struct Scene::Implementation {
  std::shared_ptr<const StaticScene> shared;
  PinholeCamera camera;
  std::vector<double> masking_alpha;  ///< one a material
  std::vector<LightDescription> lights;
  LightGathering gathering;
  int width, height, subpixels;

  /// Fills pixels [row * width, (row + 1) * width) of `rows`, and `queries`.
  void trace_row(int row, TracedRows* rows, RowQueries* queries) const;
  Color shade(const CameraRay& ray, const Hit& hit, const Subpixel& subpixel, PixelMeans* means,
              RowQueries* queries) const;
  LitBrdf lit_brdf(const GlintQuery& query, const LitPoint& point, const Illumination& incident) const;
};

Scene::Scene(const SceneDescription& description, int width, int height, int subpixels,
             std::vector<double> masking_alpha, LightGathering gathering) {
  if (width < 1 || height < 1) throw UsageError(fmt::format("image of {} x {} pixels", width, height));
  if (subpixels < 1 || subpixels > 16)
    throw UsageError(fmt::format("subpixels: found {}, expected 1 to 16", subpixels));
  complete(&masking_alpha, description.materials.size());
  check_lights(description.lights);
  gathering.patch_materials.resize(description.materials.size(), false);
  const PinholeCamera camera(description.camera, width, height);
  implementation_.reset(new Implementation{
      std::make_shared<const StaticScene>(make_static_scene(description)), camera, std::move(masking_alpha),
      description.lights, std::move(gathering), width, height, subpixels});
}

Scene::Scene(std::unique_ptr<Implementation> implementation) : implementation_(std::move(implementation)) {}

Scene::~Scene() = default;
Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(Scene&&) noexcept = default;

const Findings& Scene::findings() const {
  return implementation_->shared->findings;
}
const Geometry& Scene::geometry() const {
  return implementation_->shared->geometry;
}
const Environment& Scene::environment() const {
  return implementation_->shared->environment;
}
const std::vector<LightDescription>& Scene::lights() const {
  return implementation_->lights;
}
const std::vector<MaterialDescription>& Scene::materials() const {
  return implementation_->shared->materials;
}
std::uint32_t Scene::material_of(const Hit& hit) const {
  return implementation_->shared->part_materials[hit.shape][hit.part];
}
const std::optional<CoatInterface>& Scene::coat(std::uint32_t material) const {
  return implementation_->shared->coats[material];
}
double Scene::masking_alpha(std::uint32_t material) const {
  return implementation_->masking_alpha[material];
}

LitBrdf Scene::Implementation::lit_brdf(const GlintQuery& query, const LitPoint& point,
                                        const Illumination& incident) const {
  LitBrdf lit;
  const Eigen::Vector3d light = point.frame.to_local(incident.direction);
  const CoatCrossing crossing(shared->coats[query.material], point.frame.to_local(point.to_eye));
  lit.query = {query.query.footprint, crossing.view_below(), crossing.below(light), query.query.roughness};
  lit.pixel = query.pixel;
  lit.material = query.material;
  const Color irradiance = incident.irradiance * (crossing.value_scale(light) / (subpixels * subpixels));
  const BounceFresnel fresnel(shared->materials[query.material].specular, lit.query.view, lit.query.light);
  lit.weight_single = fresnel.single.cwiseProduct(irradiance).cast<float>();
  lit.weight_multiple = fresnel.multiple.cwiseProduct(irradiance).cast<float>();
  return lit;
}

Scene Scene::with_view(const CameraDescription& camera, const std::vector<LightDescription>& lights,
                       const std::vector<double>& masking_alpha) const {
  const Implementation& self = *implementation_;
  std::vector<double> alphas = masking_alpha;
  complete(&alphas, self.shared->materials.size());
  check_lights(lights);
  return Scene(std::unique_ptr<Implementation>(
      new Implementation{self.shared, PinholeCamera(camera, self.width, self.height), std::move(alphas),
                         lights, self.gathering, self.width, self.height, self.subpixels}));
}

Color Scene::Implementation::shade(const CameraRay& ray, const Hit& hit, const Subpixel& subpixel,
                                   PixelMeans* means, RowQueries* queries) const {
  const std::uint32_t material_index = shared->part_materials[hit.shape][hit.part];
  const MaterialDescription& material = shared->materials[material_index];
  const std::optional<CoatInterface>& coat = shared->coats[material_index];
  const Eigen::Vector3d to_eye = -ray.direction.normalized();
  const TangentFrame frame = tangent_frame(hit, to_eye);
  const Eigen::Matrix2d duv = material.repeat.asDiagonal() * uv_differentials(ray, hit);
  const double alpha = masking_alpha[material_index];

  GlintQuery query;
  query.query.footprint.mean_uv = wrap(hit.uv.cwiseProduct(material.repeat));
  query.query.footprint.cov_uv = footprint_covariance(duv, kFilterSigmaSubpixels / subpixels);
  query.pixel = subpixel.pixel;
  query.material = material_index;
  means->add(query.query.footprint, frame.z);
  Color smooth = Color::Zero();  // what needs no P-NDF
  if (frame.face_normal.dot(to_eye) < kMinCosine) return smooth;
  const std::optional<GlintMaterial>& glints = shared->glints[material_index];
  std::vector<GlintPlace> places = {{query.query.footprint, frame.x, frame.y, material.roughness, {}}};
  if (glints) places = glints->places(ray, hit, frame, kFilterSigmaSubpixels / subpixels);

  const LitPoint point{hit,           frame, to_eye, places.front().footprint, subpixel.pixel, subpixel.index,
                       material_index};
  if (gathering.points) queries->points.push_back(point);

  for (const LightDescription& light : lights) {
    const Illumination incident = illuminate(light, hit.position);
    if (!(incident.irradiance.maxCoeff() > 0)) continue;
    const double cos_i = incident.direction.dot(frame.z);
    if (cos_i < kMinCosine || incident.direction.dot(frame.face_normal) < kMinCosine) continue;
    const LightRay to_light = light_ray(light, hit.position, subpixel.light_sample);
    if (to_light.direction.dot(frame.face_normal) < kMinCosine) continue;
    if (shared->geometry.occluded(hit, to_light.direction, to_light.distance)) continue;

    const LobesSeen seen = see_lobes(material, coat, alpha, frame.z, to_eye, incident);
    smooth += seen.smooth.cwiseProduct(incident.irradiance);
    if (gathering.patch_materials[material_index]) {
      query.query.half_vector = frame.on_disk(seen.half_vector);
      query.query.roughness = seen.roughness;
      queries->lit.push_back(lit_brdf(query, point, incident));
      continue;
    }
    const Color weight = glints ? glints->weight(hit, places.front(), frame, to_eye, seen, incident.direction)
                                : seen.glint_weight;
    query.weight = weight.cwiseProduct(incident.irradiance / (subpixels * subpixels)).cast<float>();
    if (!(query.weight.maxCoeff() > 0)) continue;
    for (const GlintPlace& place : places) {
      query.query.footprint = place.footprint;
      query.query.half_vector = {seen.half_vector.dot(place.x), seen.half_vector.dot(place.y)};
      query.query.roughness = glints ? glints->microroughness(place, seen) : seen.roughness;
      query.glints = place.point;
      queries->glints.push_back(query);
    }
  }
  return smooth;
}

void Scene::Implementation::trace_row(int row, TracedRows* rows, RowQueries* queries) const {
  const double step = 1.0 / subpixels;
  const auto first_pixel = static_cast<std::uint64_t>(rows->first_row) * static_cast<std::uint64_t>(width);
  for (int column = 0; column < width; ++column) {
    const std::size_t pixel =
        static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column);
    const std::size_t queries_before = queries->size();
    PixelMeans means;
    Color radiance = Color::Zero();
    for (int subpixel = 0; subpixel < subpixels * subpixels; ++subpixel) {
      const int i = subpixel % subpixels, j = subpixel / subpixels;
      const double x = column + (i + 0.5) * step;
      const double y = rows->first_row + row + (j + 0.5) * step;
      const CameraRay ray = camera.ray(x, y);
      const std::optional<Hit> hit = shared->geometry.intersect({ray.origin, ray.direction});
      const Subpixel here{static_cast<std::uint32_t>(pixel), static_cast<std::uint32_t>(subpixel),
                          shadow_sample(first_pixel + pixel, subpixel, subpixels)};
      radiance += hit ? shade(ray, *hit, here, &means, queries) : shared->far_radiance(ray.direction);
    }
    rows->radiance[pixel] = (radiance * step * step).cast<float>();
    rows->query_count[pixel] =
        static_cast<std::uint16_t>(std::min<std::size_t>(queries->size() - queries_before, 65535));
    means.write(rows, pixel);
  }
}

TracedRows Scene::trace(int first_row, int row_count) const {
  const Implementation& self = *implementation_;
  if (first_row < 0 || row_count < 0 || first_row > self.height - row_count)
    throw UsageError(
        fmt::format("rows {} to {} of an image of {} rows", first_row, first_row + row_count, self.height));
  TracedRows rows = empty_rows(first_row, row_count, self.width);
  std::vector<RowQueries> row_queries(static_cast<std::size_t>(row_count));
  tbb::parallel_for(0, row_count, [&](int row) {
    self.trace_row(row, &rows, &row_queries[static_cast<std::size_t>(row)]);
  });
  join(&row_queries, &RowQueries::glints, &rows.queries);
  join(&row_queries, &RowQueries::points, &rows.points);
  join(&row_queries, &RowQueries::lit, &rows.lit);
  return rows;
}

}  // namespace mica::host
