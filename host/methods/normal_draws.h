#pragma once

#include <Eigen/Core>

#include "host/base/query.h"

namespace mica::host {

/// A BRDF that mirrors light at normals which can be drawn with the very density that it is made of: that
/// cancels in the weight of a draw, and need not be known.
class NormalDraws {
 public:
  struct Drawn {
    Eigen::Vector3d light;  ///< unit, in the tangent frame of the map
    double weight;          ///< of that direction, or 0 where nothing was drawn
  };

  virtual ~NormalDraws() = default;

  /// @param uniform four numbers in [0, 1): two for the place on the map, two for the normal there.
  virtual Drawn draw_normal(const ViewQuery& from, const Eigen::Vector4d& uniform) const = 0;

  /// What the BRDF, its cosine within, is over the density per steradian with which `draw_normal` draws the
  /// light's direction; 0 below the horizon. The density of the normals is not asked for.
  virtual double normal_weight(const BrdfQuery& query) const = 0;
};

}  // namespace mica::host
