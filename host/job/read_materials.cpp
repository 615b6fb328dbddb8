#include <fmt/format.h>

#include <algorithm>

#include "host/job/read_job.h"

namespace mica {
namespace {

const Interval reflectance = closed(0, 1);

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
  const std::vector<std::string_view> available = {"triangles", "grid"};
  const std::vector<std::string_view> planned = {"auto",   "gaussians", "beckmanns", "cavities",
                                                 "smooth", "pyramid",   "reference"};
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
    }
    table.read_table("specular", [&](TableReader& specular) { material.specular = read_specular(specular); });
    table.read("diffuse", material.diffuse, reflectance);
    table.read_table("coat", [&](TableReader& coat) { material.coat = read_coat(coat); });
    materials.push_back(std::move(material));
  });
  return materials;
}

}  // namespace mica
