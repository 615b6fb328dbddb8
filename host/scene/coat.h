#pragma once

#include <Eigen/Core>

#include "host/scene/description.h"
#include "host/scene/shading.h"

namespace mica::host {

/// A smooth interface of a dielectric coat over a material, both parallel: what crosses it.
///
/// Light is refracted on its way in and out, and loses what the interface reflects; what the material sends
/// back into the coat at angles beyond the critical one returns to it, which matters for the diffuse lobe
/// alone. The radiance that leaves a medium of index n falls by n^2.
class CoatInterface {
 public:
  explicit CoatInterface(const CoatDescription& coat);

  /// Inside the coat, of a unit direction outside it and above the horizon of `n`. Snell.
  Eigen::Vector3d refracted(const Eigen::Vector3d& direction, const Eigen::Vector3d& n) const;

  /// Share of the irradiance on the interface that a lobe below it turns into radiance above:
  /// f(o, i) cos_i = crossing(o, i) cos_i f_below(o', i') with o', i' refracted.
  double crossing(double cos_o, double cos_i) const;

  /// f of a Lambertian lobe of this albedo below the interface, with all light that goes to and fro; energy
  /// is kept: white under a coat loses nothing. @return above the coat, 1/sr.
  Color diffuse(const Color& albedo, double cos_o, double cos_i) const;

  /// What glint_weight says of a material without a coat, for one below this one: f_r max(i.n, 0) / D, D
  /// being that at the half vector of the refracted directions.
  Color glint_weight(const Fresnel& fresnel, double masking_alpha, const Eigen::Vector3d& n,
                     const Eigen::Vector3d& to_eye, const Eigen::Vector3d& to_light) const;

  /// f_r max(i.n, 0) of the interface itself, whose slopes are Gaussian.
  /// @param light_variance of the half vector for a light that is no point, see half_vector_variance.
  double reflection(const Eigen::Vector3d& n, const Eigen::Vector3d& to_eye, const Eigen::Vector3d& to_light,
                    double light_variance) const;

  double ior() const { return coat_.ior; }

 private:
  CoatDescription coat_;
  double inner_reflectance_;  ///< share of diffuse light from below that it sends back
};

}  // namespace mica::host
