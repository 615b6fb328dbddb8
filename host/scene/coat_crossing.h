#pragma once

#include <Eigen/Core>

#include "host/scene/layered_material.h"

namespace mica::host {

/// Directions of a BRDF that may lie below a coat, seen from a view above it. All are unit and in the tangent
/// frame; without a coat above and below are the same.
class CoatCrossing {
 public:
  /// @param layers must outlive this; @param view above the horizon.
  CoatCrossing(const LayeredMaterial& layers, const Eigen::Vector3d& view);

  const Eigen::Vector3d& view_below() const { return view_below_; }
  Eigen::Vector3d below(const Eigen::Vector3d& light) const;

  /// Where light from a direction below comes from; below the horizon when nothing crosses the interface
  /// there.
  Eigen::Vector3d above(const Eigen::Vector3d& light_below) const;

  /// What the BRDF's answer, its cosine within, is multiplied with above: crossings, the light that goes
  /// to and fro, and that which bounces on between facets.
  Color value_scale(const Eigen::Vector3d& light) const;

  /// What a density of directions below is multiplied with, above: d below / d light.
  double density_scale(const Eigen::Vector3d& light) const;

 private:
  const LayeredMaterial& layers_;
  Eigen::Vector3d view_, view_below_;
};

}  // namespace mica::host
