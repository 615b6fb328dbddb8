#pragma once

#include <Eigen/Core>
#include <optional>

#include "host/scene/coat.h"

namespace mica::host {

/// Directions of a BRDF that may lie below a coat, seen from a view above it. All are unit and in the tangent
/// frame; without a coat above and below are the same.
class CoatCrossing {
 public:
  /// @param coat must outlive this; @param view above the horizon.
  CoatCrossing(const std::optional<CoatInterface>& coat, const Eigen::Vector3d& view);

  const Eigen::Vector3d& view_below() const { return view_below_; }
  Eigen::Vector3d below(const Eigen::Vector3d& light) const;

  /// Where light from a direction below comes from; below the horizon when nothing crosses the interface
  /// there.
  Eigen::Vector3d above(const Eigen::Vector3d& light_below) const;

  /// What f_r max(i.g, 0) of the BRDF is multiplied with, above.
  double value_scale(const Eigen::Vector3d& light) const;

  /// What a density of directions below is multiplied with, above: d below / d light.
  double density_scale(const Eigen::Vector3d& light) const;

 private:
  const std::optional<CoatInterface>& coat_;
  Eigen::Vector3d view_, view_below_;
};

}  // namespace mica::host
