#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "host/scene/base_energy.h"
#include "host/scene/coat.h"
#include "host/scene/description.h"

namespace mica::host {

/// A material as light meets it: a coat where there is one, and below it a base that mirrors and scatters.
struct LayeredMaterial {
  /// @param masking_alpha Beckmann roughness of its map and its own, for Smith's G.
  LayeredMaterial(const MaterialDescription& material, double masking_alpha);

  /// What mirrored light is multiplied with, f_r max(i.n, 0) in the coat, for that outside: crossings of the
  /// coat, and light between it and the base. 1 without a coat. @param cos_o, cos_i outside, (0, 1].
  Color passed(double cos_o, double cos_i) const;

  MaterialDescription material;  ///< whose Fresnel factor is that of the base in its coat
  std::optional<CoatInterface> coat;
  double masking_alpha;
  BaseEnergy energy;
};

/// One a material; shared by scenes that differ in their views.
using LayeredMaterials = std::vector<LayeredMaterial>;
std::shared_ptr<const LayeredMaterials> make_layers(const std::vector<MaterialDescription>& materials,
                                                    const std::vector<double>& masking_alpha);

}  // namespace mica::host
