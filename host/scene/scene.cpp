#include "host/scene/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/scene/trace_rows.h"
#include "host/scene/viewer.h"
#include "mica/error.h"

namespace mica::host {
namespace {

constexpr double kDefaultAlpha = 0.1;

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

void check_lights(const std::vector<LightDescription>& lights) {
  for (std::size_t i = 0; i < lights.size(); ++i)
    if (!std::visit(IsUsableLight{}, lights[i]))
      throw UsageError(fmt::format("light {}: expected finite values and no negative power", i + 1));
}

void complete(std::vector<SmoothLobe>* lobes, std::size_t materials) {
  for (const SmoothLobe& lobe : *lobes)
    if (!std::isfinite(lobe.mean_alpha()))
      throw UsageError(fmt::format("lobe of alpha {}", lobe.mean_alpha()));
  lobes->resize(materials, kDefaultAlpha);
}

void complete(PixelSettings* pixels, std::size_t materials) {
  if (pixels->subpixels < 1 || pixels->subpixels > 16)
    throw UsageError(fmt::format("subpixels: found {}, expected 1 to 16", pixels->subpixels));
  pixels->takes_first_order.resize(materials, false);
}

}  // namespace

void add_samples(const TracedRows& rows, const std::vector<Eigen::Vector3d>& sample_radiance,
                 std::vector<Eigen::Vector3d>* radiance) {
  const auto width = static_cast<std::size_t>(rows.lattice.width);
  for (std::size_t pixel = 0; pixel < radiance->size(); ++pixel)
    if (!rows.fitted[pixel])
      rows.lattice.sum(
          static_cast<int>(pixel / width), static_cast<int>(pixel % width), rows.lattice.all(),
          [&](std::size_t sample, double weight) { (*radiance)[pixel] += weight * sample_radiance[sample]; });
}

struct Scene::Implementation {
  Viewer viewer;
  PixelSettings pixels;
  int width, height;
};

Scene::Scene(const SceneDescription& description, int width, int height, PixelSettings pixels,
             std::vector<SmoothLobe> lobes, LightGathering gathering) {
  if (width < 1 || height < 1) throw UsageError(fmt::format("image of {} x {} pixels", width, height));
  const std::size_t materials = description.materials.size();
  complete(&lobes, materials);
  check_lights(description.lights);
  gathering.patch_materials.resize(materials, false);
  complete(&pixels, materials);
  const PinholeCamera camera(description.camera, width, height);
  implementation_.reset(new Implementation{
      {std::make_shared<const StaticScene>(description), camera, make_layers(description.materials, lobes),
       description.lights, std::move(gathering)},
      std::move(pixels),
      width,
      height});
}

Scene::Scene(const SceneDescription& description, int width, int height, int subpixels,
             std::vector<SmoothLobe> lobes, LightGathering gathering)
    : Scene(
          description, width, height,
          [&] {
            PixelSettings pixels;
            pixels.subpixels = subpixels;
            return pixels;
          }(),
          std::move(lobes), std::move(gathering)) {}

Scene::Scene(std::unique_ptr<Implementation> implementation) : implementation_(std::move(implementation)) {}

Scene::~Scene() = default;
Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(Scene&&) noexcept = default;

const Viewer& Scene::viewer() const {
  return implementation_->viewer;
}
const PixelSettings& Scene::pixels() const {
  return implementation_->pixels;
}
const Findings& Scene::findings() const {
  return implementation_->viewer.shared->findings;
}
const Geometry& Scene::geometry() const {
  return implementation_->viewer.shared->geometry;
}
const Environment& Scene::environment() const {
  return implementation_->viewer.shared->environment;
}
const std::vector<LightDescription>& Scene::lights() const {
  return implementation_->viewer.lights;
}
const std::vector<MaterialDescription>& Scene::materials() const {
  return implementation_->viewer.shared->materials;
}
std::uint32_t Scene::material_of(const Hit& hit) const {
  return implementation_->viewer.shared->part_materials[hit.shape][hit.part];
}
const LayeredMaterial& Scene::layers(std::uint32_t material) const {
  return (*implementation_->viewer.layers)[material];
}

SmoothNormals Scene::normals_from_afar(std::uint32_t material, const Hit& hit) const {
  const std::optional<GlintMaterial>& glints = implementation_->viewer.shared->glints[material];
  return glints ? glints->from_afar(hit.uv) : SmoothNormals{layers(material).lobe, Color::Ones()};
}

Scene Scene::with_view(const CameraDescription& camera, const std::vector<LightDescription>& lights,
                       const std::vector<SmoothLobe>& lobes, PixelSettings pixels) const {
  const Implementation& self = *implementation_;
  complete(&pixels, self.viewer.shared->materials.size());
  std::vector<SmoothLobe> completed = lobes;
  complete(&completed, self.viewer.shared->materials.size());
  check_lights(lights);
  const bool same =
      std::equal(completed.begin(), completed.end(), self.viewer.layers->begin(),
                 [](const SmoothLobe& lobe, const LayeredMaterial& m) { return lobe == m.lobe; });
  return Scene(std::unique_ptr<Implementation>(
      new Implementation{{self.viewer.shared, PinholeCamera(camera, self.width, self.height),
                          same ? self.viewer.layers : make_layers(self.viewer.shared->materials, completed),
                          lights, self.viewer.gathering},
                         std::move(pixels),
                         self.width,
                         self.height}));
}

TracedRows Scene::trace(int first_row, int row_count) const {
  const Implementation& self = *implementation_;
  if (first_row < 0 || row_count < 0 || first_row > self.height - row_count)
    throw UsageError(
        fmt::format("rows {} to {} of an image of {} rows", first_row, first_row + row_count, self.height));
  return trace_rows(self.viewer, self.pixels, {self.width, self.height, first_row, row_count, 0, self.width});
}

Lattice Scene::lattice(const PixelSettings& pixels) const {
  return {implementation_->width,
          pixels.filter.margin_pixels(),
          pixels.subpixels,
          pixels.filter.on_lattice(pixels.subpixels),
          {}};
}

TracedRows Scene::sample(int first_row, int row_count, const Lattice::Choice& chosen,
                         const PixelSettings& pixels) const {
  const Implementation& self = *implementation_;
  return sample_rows(self.viewer, pixels, {self.width, self.height, first_row, row_count, 0, self.width},
                     chosen);
}

TracedRows Scene::trace_pixel(int row, int column, const PixelSettings& pixels) const {
  const Implementation& self = *implementation_;
  return trace_rows(self.viewer, pixels, {self.width, self.height, row, 1, column, 1});
}

}  // namespace mica::host
