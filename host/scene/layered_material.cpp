#include "host/scene/layered_material.h"

#include <cmath>

#include "host/scene/fresnel.h"

namespace mica::host {
namespace {

MaterialDescription in_its_coat(MaterialDescription material) {
  if (material.coat) material.specular = below(material.specular, material.coat->ior);
  return material;
}

}  // namespace

LayeredMaterial::LayeredMaterial(const MaterialDescription& described, const SmoothLobe& lobe)
    : material(in_its_coat(described)),
      coat(material.coat ? std::optional<CoatInterface>(*material.coat) : std::nullopt),
      lobe(lobe),
      masking_alpha(lobe.mean_alpha()),
      energy(material, masking_alpha) {
  if (material.multiple_scattering == MultipleScattering::kept) mirrored_energy.emplace(material, lobe);
}

Color LayeredMaterial::passed(double cos_o, double cos_i) const {
  if (!coat) return Color::Ones();
  const double cos_i_below = std::sqrt(1 - (1 - cos_i * cos_i) / (coat->ior() * coat->ior()));  // Snell
  // A BRDF holds the cosine in the coat; irradiance is that outside.
  return coat->crossing(cos_o, cos_i) * cos_i / cos_i_below * energy.interreflection(cos_o, cos_i);
}

std::shared_ptr<const LayeredMaterials> make_layers(const std::vector<MaterialDescription>& materials,
                                                    const std::vector<SmoothLobe>& lobes) {
  auto layers = std::make_shared<LayeredMaterials>();
  for (std::size_t n = 0; n < materials.size(); ++n) layers->emplace_back(materials[n], lobes[n]);
  return layers;
}

}  // namespace mica::host
