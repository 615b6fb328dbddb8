#include "host/scene/scene.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "host/base/error.h"
#include "host/scene/background.h"
#include "host/scene/camera.h"
#include "host/scene/footprint.h"
#include "host/scene/geometry.h"
#include "host/scene/shading.h"

namespace mica {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double default_masking_alpha = 0.1;
constexpr double filter_sigma_subpixels = 0.5;

/// To [0, 1); of a tiny negative number, 1 - x would round to 1.
Eigen::Vector2d wrap(const Eigen::Vector2d& uv) {
  const Eigen::Vector2d wrapped = uv - uv.array().floor().matrix();
  return (wrapped.array() < 1).select(wrapped, 0);
}

std::vector<std::uint32_t> materials_of_shapes(const SceneDescription& description) {
  std::vector<std::uint32_t> indices;
  for (const ShapeDescription& shape : description.shapes) {
    const auto found = std::find_if(description.materials.begin(), description.materials.end(),
                                    [&](const MaterialDescription& m) { return m.name == shape.material; });
    if (found == description.materials.end())
      throw UsageError(
          fmt::format("shape {}: there is no material '{}'", indices.size() + 1, shape.material));
    indices.push_back(static_cast<std::uint32_t>(found - description.materials.begin()));
  }
  return indices;
}

struct IsUsableLight {
  bool operator()(const PointLight& light) const {
    return light.position.allFinite() && light.intensity.allFinite() && light.intensity.minCoeff() >= 0;
  }
  bool operator()(const DirectionalLight& light) const {
    return light.direction.allFinite() && light.direction.norm() > 0 && light.irradiance.allFinite() &&
           light.irradiance.minCoeff() >= 0;
  }
};

/// Indices of a subpixel, as in LitPoint.
struct Place {
  std::uint32_t pixel, subpixel;
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

struct Scene::Implementation {
  PinholeCamera camera;
  Geometry geometry;
  Background background;
  Environment environment;
  std::vector<MaterialDescription> materials;
  std::vector<double> masking_alpha;          ///< of each material
  std::vector<std::uint32_t> shape_material;  ///< index of each shape's material
  std::vector<LightDescription> lights;
  LightGathering gathering;
  bool shows_environment;  ///< where rays hit nothing
  int width, height, subpixels;

  /// Fills pixels [row * width, (row + 1) * width) of `rows`, and `queries`.
  void trace_row(int row, TracedRows* rows, RowQueries* queries) const;
  Color shade(const CameraRay& ray, const Hit& hit, Place at, PixelMeans* means, RowQueries* queries) const;
  LitBrdf lit_brdf(const GlintQuery& query, const LitPoint& point, const Illumination& incident) const;
};

Scene::Scene(const SceneDescription& description, int width, int height, int subpixels,
             std::vector<double> masking_alpha, LightGathering gathering) {
  if (width < 1 || height < 1) throw UsageError(fmt::format("image of {} x {} pixels", width, height));
  if (subpixels < 1 || subpixels > 16)
    throw UsageError(fmt::format("subpixels: found {}, expected 1 to 16", subpixels));
  for (const double alpha : masking_alpha)
    if (!(alpha >= 0 && std::isfinite(alpha))) throw UsageError(fmt::format("masking alpha of {}", alpha));
  for (std::size_t i = 0; i < description.lights.size(); ++i)
    if (!std::visit(IsUsableLight{}, description.lights[i]))
      throw UsageError(fmt::format("light {}: expected finite values and no negative power", i + 1));
  masking_alpha.resize(description.materials.size(), default_masking_alpha);
  gathering.patch_materials.resize(description.materials.size(), false);

  std::vector<std::uint32_t> shape_material = materials_of_shapes(description);
  implementation_.reset(new Implementation{
      PinholeCamera(description.camera, width, height), Geometry(description.shapes),
      Background(description.background), Environment(description.environments), description.materials,
      std::move(masking_alpha), std::move(shape_material), description.lights, std::move(gathering),
      description.background.is_environment, width, height, subpixels});
}

Scene::~Scene() = default;
Scene::Scene(Scene&&) noexcept = default;

const Geometry& Scene::geometry() const {
  return implementation_->geometry;
}
const Environment& Scene::environment() const {
  return implementation_->environment;
}
const std::vector<LightDescription>& Scene::lights() const {
  return implementation_->lights;
}
const std::vector<MaterialDescription>& Scene::materials() const {
  return implementation_->materials;
}
std::uint32_t Scene::material_of(const Hit& hit) const {
  return implementation_->shape_material[hit.shape];
}
double Scene::masking_alpha(std::uint32_t material) const {
  return implementation_->masking_alpha[material];
}

LitBrdf Scene::Implementation::lit_brdf(const GlintQuery& query, const LitPoint& point,
                                        const Illumination& incident) const {
  LitBrdf lit;
  lit.query = {query.query.footprint, point.frame.to_local(point.to_eye),
               point.frame.to_local(incident.direction), query.query.roughness};
  lit.pixel = query.pixel;
  lit.material = query.material;
  const Color irradiance = incident.irradiance / (subpixels * subpixels);
  const BounceFresnel fresnel(materials[query.material].specular, lit.query.view, lit.query.light);
  lit.weight_single = fresnel.single.cwiseProduct(irradiance).cast<float>();
  lit.weight_multiple = fresnel.multiple.cwiseProduct(irradiance).cast<float>();
  return lit;
}

Color Scene::Implementation::shade(const CameraRay& ray, const Hit& hit, Place at, PixelMeans* means,
                                   RowQueries* queries) const {
  const std::uint32_t material_index = shape_material[hit.shape];
  const MaterialDescription& material = materials[material_index];
  const Eigen::Vector3d to_eye = -ray.direction.normalized();
  const TangentFrame frame = tangent_frame(hit, to_eye);
  const Eigen::Matrix2d duv = material.repeat.asDiagonal() * uv_differentials(ray, hit);

  GlintQuery query;
  query.query.footprint.mean_uv = wrap(hit.uv.cwiseProduct(material.repeat));
  query.query.footprint.cov_uv = footprint_covariance(duv, filter_sigma_subpixels / subpixels);
  query.query.roughness = material.roughness;
  query.pixel = at.pixel;
  query.material = material_index;
  means->add(query.query.footprint, frame.z);
  Color diffuse = Color::Zero();
  if (frame.face_normal.dot(to_eye) < min_cosine) return diffuse;

  const LitPoint point{hit, frame, to_eye, query.query.footprint, at.pixel, at.subpixel, material_index};
  if (gathering.points) queries->points.push_back(point);

  for (const LightDescription& light : lights) {
    const Illumination incident = illuminate(light, hit.position);
    const double cos_i = incident.direction.dot(frame.z);
    if (cos_i < min_cosine || incident.direction.dot(frame.face_normal) < min_cosine) continue;
    if (geometry.occluded(hit, incident.direction, incident.distance)) continue;
    diffuse += (material.diffuse / pi * cos_i).cwiseProduct(incident.irradiance);

    if (gathering.patch_materials[material_index]) {
      queries->lit.push_back(lit_brdf(query, point, incident));
      continue;
    }
    query.query.half_vector = frame.on_disk((to_eye + incident.direction).normalized());
    query.weight =
        glint_weight(material.specular, masking_alpha[material_index], frame.z, to_eye, incident.direction)
            .cwiseProduct(incident.irradiance / (subpixels * subpixels))
            .cast<float>();
    if (query.weight.maxCoeff() > 0) queries->glints.push_back(query);
  }
  return diffuse;
}

void Scene::Implementation::trace_row(int row, TracedRows* rows, RowQueries* queries) const {
  const double step = 1.0 / subpixels;
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
      const std::optional<Hit> hit = geometry.intersect({ray.origin, ray.direction});
      const Place at{static_cast<std::uint32_t>(pixel), static_cast<std::uint32_t>(subpixel)};
      radiance += hit                 ? shade(ray, *hit, at, &means, queries)
                  : shows_environment ? environment.radiance(ray.direction)
                                      : background.radiance(ray.direction);
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

}  // namespace mica
