#include <fmt/format.h>

#include <algorithm>

#include "host/job/read_job.h"
#include "host/job/toml_settings.h"
#include "host/methods/registry.h"

namespace mica::host {
namespace {

const Interval kReflectance = closed(0, 1);
constexpr double kLargestId = 1 << 24;  // that a float tells from its neighbours

Fresnel read_conductor(TableReader& specular) {
  ConductorFresnel conductor;
  if (specular.require("eta", "it beside \"k\"")) specular.read("eta", conductor.eta, open_low(0, 100));
  if (specular.require("k", "it beside \"eta\"")) specular.read("k", conductor.k, closed(0, 100));
  return conductor;
}

Fresnel read_dielectric(TableReader& specular) {
  DielectricFresnel dielectric;
  specular.read("ior", dielectric.ior, closed(1, 10));
  return dielectric;
}

Fresnel read_color(TableReader& specular) {
  ColorFresnel color;
  specular.read("color", color.color, kReflectance);
  return color;
}

Fresnel read_specular(TableReader& specular) {
  const bool conductor = specular.has("eta") || specular.has("k");
  const bool dielectric = specular.has("ior"), color = specular.has("color");
  if (conductor + dielectric + color != 1) {
    specular.report("found no single kind of reflection; expected { eta, k }, { ior } or { color }");
    specular.accept_any_key();
    return ColorFresnel{};
  }
  return conductor ? read_conductor(specular) : dielectric ? read_dielectric(specular) : read_color(specular);
}

CoatDescription read_coat(TableReader& table) {
  CoatDescription coat;
  table.read("ior", coat.ior, closed(1.01, 4));
  table.read("roughness", coat.roughness, closed(1e-3, 1));
  return coat;
}

/// The method that `ndf` names; the default where it names none that there is.
const Method& read_method(TableReader& material, std::string& ndf, const MethodRegistry& methods) {
  const std::vector<std::string> available =
      methods.names([](const MethodTraits& traits) { return traits.jobs; });
  const std::vector<std::string_view> words(available.begin(), available.end());
  std::string word = ndf;
  material.read("ndf", word);
  const Method* const found = methods.find(word);
  if (found != nullptr && found->traits().jobs) {
    ndf = word;
    return *found;
  }
  material.report(
      "ndf", fmt::format("found {}{}; expected an evaluator that is available: {}{}", in_quotes(word),
                         found != nullptr ? ", which is not available in this version" : "", joined(words),
                         did_you_mean(word, words)));
  return methods.get(ndf);
}

/// Mixtures have no lobes for Catmull-Rom patches.
void refuse_interpolation(TableReader& table, const MaterialDescription& material, const Method& method,
                          const std::vector<SurfaceDescription>& surfaces) {
  for (const SurfaceDescription& surface : surfaces)
    if (surface.name == material.surface && !method.takes(surface.interpolation))
      table.report("ndf",
                   fmt::format("found {} on surface {}, which is bicubic; expected a nearest or bilinear "
                               "surface, or triangles",
                               in_quotes(material.ndf), in_quotes(surface.name)));
}

bool has_map_and_densities(const Method& method) {
  return method.traits().map && method.traits().densities;
}

/// The settings of the material's method. Keys of the other methods of a map's densities are read as well,
/// and not used: a job tries another method by its name alone.
std::shared_ptr<const MethodSettings> read_settings_of(TableReader& table, const Method& method,
                                                       const MethodRegistry& methods) {
  std::unique_ptr<MethodSettings> settings = method.settings();
  std::vector<std::unique_ptr<MethodSettings>> unused;
  TomlSettings reader(table);
  settings->visit(reader);
  if (has_map_and_densities(method))
    for (const auto& other : methods.all())
      if (has_map_and_densities(*other)) unused.emplace_back(other->settings())->visit(reader);
  reader.read_files();
  const MethodTraits traits = method.traits();
  if (traits.keeps_tolerance || has_map_and_densities(method)) {
    double tolerance = 0;
    table.read("tolerance", tolerance, closed(traits.chooses ? 5e-4 : 1e-4, 0.5));
    if (tolerance > 0 && traits.keeps_tolerance) settings->tolerance = tolerance;
  }
  if (const MethodSettings::Problem problem = settings->problem(); !problem.message.empty())
    table.report(problem.key, problem.message);
  return settings;
}

void read_surface(TableReader& table, MaterialDescription& material,
                  const std::vector<SurfaceDescription>& surfaces) {
  std::vector<std::string_view> names;
  for (const SurfaceDescription& surface : surfaces) names.push_back(surface.name);
  table.require("surface", "the name of a surface");
  table.read_reference("surface", material.surface, "surface", names);
  Eigen::Vector2d roughness = Eigen::Vector2d::Constant(material.roughness);
  table.read_one_or_two("roughness", roughness, closed(1e-4, 1));
  material.roughness = roughness.x();
  if (roughness.x() == roughness.y()) return;
  material.roughness = std::sqrt(roughness.squaredNorm() / 2);
  material.long_roughness = roughness;
}

void read_id(TableReader& table, MaterialDescription& material,
             const std::vector<MaterialDescription>& others) {
  int id = 0;
  table.read("id", id, closed(1, kLargestId));
  if (id == 0) return;
  material.id = id;
  for (const MaterialDescription& other : others)
    if (other.id == id)
      table.report("id", fmt::format("found {}, which material {} has; expected one of its own", id,
                                     in_quotes(other.name)));
}

}  // namespace

std::vector<MaterialDescription> read_materials(TableReader& job,
                                                const std::vector<SurfaceDescription>& surfaces,
                                                const MethodRegistry& methods) {
  std::vector<MaterialDescription> materials;
  job.read_named_tables("material", [&](TableReader& table) {
    MaterialDescription material;
    material.name = table.name();
    table.read("repeat", material.repeat, open_low(0, 1e6));
    const Method& method = read_method(table, material.ndf, methods);
    if (method.traits().map) {
      read_surface(table, material, surfaces);
      refuse_interpolation(table, material, method, surfaces);
    }
    material.settings = read_settings_of(table, method, methods);
    material.roughness = material.settings->own_roughness().value_or(material.roughness);
    if (const GlintsDescription* const glints = material.settings->glints()) material.glints = *glints;
    table.read_table("specular", [&](TableReader& specular) { material.specular = read_specular(specular); });
    table.read("diffuse", material.diffuse, kReflectance);
    table.read("multiple_scattering", material.multiple_scattering);
    if (material.multiple_scattering == MultipleScattering::kept && method.traits().lit_by_brdf)
      table.report(
          "multiple_scattering",
          fmt::format("found \"kept\" beside ndf {}, whose BRDF answers for its own energy; expected "
                      "a density of normals, as triangles",
                      in_quotes(material.ndf)));
    read_id(table, material, materials);
    table.read_table("coat", [&](TableReader& coat) { material.coat = read_coat(coat); });
    materials.push_back(std::move(material));
  });
  return materials;
}

}  // namespace mica::host
