#include <fmt/format.h>

#include <algorithm>

#include "host/job/read_job.h"

namespace mica::host {
namespace {

const Interval reflectance = closed(0, 1);
const Choices<Masking> maskings = {
    {"exact", Masking::exact}, {"filtered", Masking::filtered}, {"geometric", Masking::geometric}};
const Choices<Compensation> compensations = {{"diffuse", Compensation::diffuse},
                                             {"specular", Compensation::specular}};
const Choices<LostEnergy> energies = {{"exact", LostEnergy::exact}, {"table", LostEnergy::table}};

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
  specular.read("color", color.color, reflectance);
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

void read_evaluator(TableReader& material, std::string& ndf) {
  const std::vector<std::string_view> available = {
      "triangles", "gaussians", "beckmanns", "smooth", "cavities", "pyramid", "auto", "grid", "normalmap"};
  const std::vector<std::string_view> planned = {"reference"};
  std::string word = ndf;
  material.read("ndf", word);
  if (std::find(available.begin(), available.end(), word) != available.end()) {
    ndf = word;
    return;
  }
  const bool is_planned = std::find(planned.begin(), planned.end(), word) != planned.end();
  material.report("ndf",
                  fmt::format("found {}{}; expected an evaluator that is available: {}{}", in_quotes(word),
                              is_planned ? ", which is not available in this version" : "", joined(available),
                              did_you_mean(word, available)));
}

/// Mixtures have no lobes for Catmull-Rom patches.
void refuse_bicubic(TableReader& table, const MaterialDescription& material,
                    const std::vector<SurfaceDescription>& surfaces) {
  for (const char* const any : {"triangles", "pyramid", "auto", "normalmap"})
    if (material.ndf == any) return;
  for (const SurfaceDescription& surface : surfaces)
    if (surface.name == material.surface && surface.interpolation == Interpolation::bicubic)
      table.report("ndf",
                   fmt::format("found {} on surface {}, which is bicubic; expected a nearest or bilinear "
                               "surface, or triangles",
                               in_quotes(material.ndf), in_quotes(surface.name)));
}

void read_cavities(TableReader& table, MaterialDescription& material) {
  table.read("compensation", material.compensation, compensations);
  table.read("energy", material.energy, energies);
  double spacing = 1;
  table.read("spacing", spacing, open_low(0, 1));
  if (spacing != 1 && spacing != 0.5)
    table.report("spacing", fmt::format("found {}; expected 1 or 0.5 texels", spacing));
  material.elements = spacing == 1 ? 1 : 2;
}

}  // namespace

std::vector<MaterialDescription> read_materials(TableReader& job,
                                                const std::vector<SurfaceDescription>& surfaces) {
  std::vector<std::string_view> surface_names;
  for (const SurfaceDescription& surface : surfaces) surface_names.push_back(surface.name);

  std::vector<MaterialDescription> materials;
  job.read_named_tables("material", [&](TableReader& table) {
    MaterialDescription material;
    material.name = table.name();
    table.read("repeat", material.repeat, open_low(0, 1e6));
    read_evaluator(table, material.ndf);
    if (material.ndf == "grid") {
      read_glints(table, material);
    } else {
      table.require("surface", "the name of a surface");
      table.read_reference("surface", material.surface, "surface", surface_names);
      table.read("roughness", material.roughness, closed(1e-4, 1));
      refuse_bicubic(table, material, surfaces);
      if (material.ndf == "cavities") {
        read_cavities(table, material);
      } else if (material.ndf != "normalmap") {
        table.read("masking", material.masking, maskings);
        table.read("elements", material.elements, closed(1, 4));
      }
    }
    table.read_table("specular", [&](TableReader& specular) { material.specular = read_specular(specular); });
    table.read("diffuse", material.diffuse, reflectance);
    table.read_table("coat", [&](TableReader& coat) { material.coat = read_coat(coat); });
    if (material.coat && (material.ndf == "cavities" || material.ndf == "normalmap"))
      table.report("coat",
                   fmt::format("found one on {}; expected none, or an ndf with a density", material.ndf));
    materials.push_back(std::move(material));
  });
  return materials;
}

}  // namespace mica::host
