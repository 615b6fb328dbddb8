#pragma once

#include <Eigen/Core>
#include <vector>

#include "host/microfacet/smooth_lobe.h"
#include "host/scene/description.h"

namespace mica::host {

/// What one bounce on a white lobe of normals sends back, E(o), and what mirrored light is multiplied with so
/// that what bounces more often comes back as well: 1 + F0 (1 - E) / E, F0 the reflectance along g. [Turquin
/// 2019]: Emmanuel Turquin, "Practical multiple scattering compensation for microfacet models".
///
/// E is that of the lobe as a whole, blurred on the disk by the roughness, with the masking that its light
/// has. Where masking lets more than all pass (a wide Gaussian on the disk has no Smith's G of its own), E is
/// above one and the factor below.
class LobeEnergy {
 public:
  /// @param lobe with the roughness of `material` in it, or that of its glints.
  LobeEnergy(const MaterialDescription& material, const SmoothLobe& lobe);

  /// E, within 5e-3. @param view unit, in the tangent frame, above the horizon.
  double albedo(const Eigen::Vector3d& view) const;

  Color factor(const Eigen::Vector3d& view) const {
    const double single = albedo(view);
    return Color::Ones() + normal_reflectance_ * ((1 - single) / single);
  }

 private:
  Color normal_reflectance_;
  std::vector<double> table_;  // row by row of a cosine; along a row, azimuths of half a turn
};

}  // namespace mica::host
