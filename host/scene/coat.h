#pragma once

#include <Eigen/Core>

#include "host/scene/description.h"
#include "host/scene/shading.h"

namespace mica::host {

/// A smooth interface of a dielectric coat over a material, both parallel: what crosses it.
///
/// Light is refracted on its way in and out, and loses what the interface reflects; what that sends back to
/// the material is BaseEnergy's. The radiance that leaves a medium of index n falls by n^2.
class CoatInterface {
 public:
  explicit CoatInterface(const CoatDescription& coat) : coat_(coat) {}

  /// Inside the coat, of a unit direction outside it and above the horizon of `n`. Snell.
  Eigen::Vector3d refracted(const Eigen::Vector3d& direction, const Eigen::Vector3d& n) const;

  /// Share of the irradiance on the interface that a lobe below it turns into radiance above:
  /// f(o, i) cos_i = crossing(o, i) cos_i f_below(o', i') with o', i' refracted.
  double crossing(double cos_o, double cos_i) const;

  /// f_r max(i.n, 0) of the interface itself, whose slopes are Gaussian.
  /// @param light_variance of the directions in which a disk is seen about `to_light`, see Illumination.
  double reflection(const Eigen::Vector3d& n, const Eigen::Vector3d& to_eye, const Eigen::Vector3d& to_light,
                    double light_variance) const;

  double ior() const { return coat_.ior; }

 private:
  CoatDescription coat_;
};

}  // namespace mica::host
