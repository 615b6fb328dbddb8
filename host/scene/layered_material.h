#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "host/microfacet/smooth_lobe.h"
#include "host/scene/base_energy.h"
#include "host/scene/coat.h"
#include "host/scene/description.h"
#include "host/scene/lobe_energy.h"

namespace mica::host {

/// A material as light meets it: a coat where there is one, and below it a base that mirrors and scatters.
struct LayeredMaterial {
  /// @param lobe of its map and its own roughness, or of its glints.
  LayeredMaterial(const MaterialDescription& material, const SmoothLobe& lobe);

  /// What mirrored light is multiplied with for that which bounces more than once between facets; 1 unless
  /// the material keeps it. @param view_below unit, in the tangent frame, in the coat.
  Color regained(const Eigen::Vector3d& view_below) const {
    return mirrored_energy ? mirrored_energy->factor(view_below) : Color::Ones();
  }

  /// What mirrored light is multiplied with, f_r max(i.n, 0) in the coat, for that outside: crossings of the
  /// coat, and light between it and the base. 1 without a coat. @param cos_o, cos_i outside, (0, 1].
  Color passed(double cos_o, double cos_i) const;

  MaterialDescription material;  ///< whose Fresnel factor is that of the base in its coat
  std::optional<CoatInterface> coat;
  SmoothLobe lobe;
  double masking_alpha;  ///< Beckmann roughness of the lobe as a whole, for Smith's G
  BaseEnergy energy;
  std::optional<LobeEnergy> mirrored_energy;
};

/// One a material; shared by scenes that differ in their views.
using LayeredMaterials = std::vector<LayeredMaterial>;
std::shared_ptr<const LayeredMaterials> make_layers(const std::vector<MaterialDescription>& materials,
                                                    const std::vector<SmoothLobe>& lobes);

}  // namespace mica::host
