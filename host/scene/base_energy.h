#pragma once

#include <Eigen/Core>
#include <array>

#include "host/scene/description.h"

namespace mica::host {

/// How the lobes of a material share the light that meets its base, so that none is given twice.
///
/// The base mirrors the share R(o) of it: Fresnel's factor, averaged over the normals that a direction sees.
/// The diffuse lobe gets the rest, 1 - R, coming and going: reciprocal, and both together return no more than
/// all. After Csaba Kelemen and Laszlo Szirmay-Kalos, "A Microfacet Based Coupled Specular-Matte BRDF Model
/// with Importance Sampling", Eurographics 2001.
///
/// A coat sends back a part of what rises from the base, all of it beyond the critical angle, and the base
/// mirrors and scatters that anew. These bounces are summed over the cosines in the coat, for a base of one
/// Beckmann lobe with the roughness of the whole map. What is mirrored several times counts as mirrored once,
/// by more: its energy is right, its wider spread is lost. docs/accuracy.md says what that is worth.
class BaseEnergy {
 public:
  /// @param material whose Fresnel factor is that of the base in its coat, see `below`. @param alpha Beckmann
  /// roughness of its map and its own.
  BaseEnergy(const MaterialDescription& material, double alpha);

  /// f of the diffuse lobe, outside. @param cos_o, cos_i outside, (0, 1]. @return 1/sr.
  Color diffuse(double cos_o, double cos_i) const;

  /// The share R of the light that the base mirrors. @param cos_below in the coat, (0, 1].
  Color mirrored(double cos_below) const;

  /// What mirrored light is multiplied with, for that between base and coat; 1 without a coat.
  Color interreflection(double cos_o, double cos_i) const;

 private:
  using Table = Eigen::ArrayX3d;  // a colour by the cosine in the coat
  using Spread = std::array<Eigen::MatrixXd, 3>;

  double place(double cos_inside) const;
  double cosine(Eigen::Index node) const;
  double leaving(Eigen::Index node) const;
  Spread mirror(const Fresnel& specular, double alpha);
  void sum_bounces(const Eigen::MatrixXd& spread, Eigen::Index channel);

  Color albedo_;
  double ior_;
  Eigen::Index trapped_, size_;  // nodes of a table: beyond the critical angle, and all
  Table passed_;                 // share of the light from a direction in the coat that is not mirrored
  Table scattered_;              // that gets to the diffuse lobe, at once or after mirrorings
  Table repeated_;               // its product for two directions is what mirrored light is multiplied with
  Color diffuse_scale_;
};

}  // namespace mica::host
