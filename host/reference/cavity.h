#pragma once

#include <Eigen/Core>
#include <vector>

#include "host/base/query.h"
#include "host/surface/surface.h"

namespace mica::host::reference {

/// A V-shaped cavity of two mirrors in a plane with normal g = z: the facet with normal `facet`, and the
/// symmetric one. [Che19] sec. 3. Directions are unit vectors that point away from the surface.
class Cavity {
 public:
  /// @param facet on the unit disk, |facet| < 1.
  explicit Cavity(const Eigen::Vector2d& facet);

  const Eigen::Vector3d& facet() const { return facet_; }  ///< omega_p
  const Eigen::Vector3d& dual() const { return dual_; }    ///< omega_s

  /// Probability that a ray from `o` meets the facet; the dual has the rest. Eqs. 2 and 3
  double intersection_probability(const Eigen::Vector3d& o) const;
  /// Visible share of the facet seen from `o`. Eq. 4
  double masking(const Eigen::Vector3d& o) const;
  /// Share of light from `o` that leaves after one bounce. Eq. 8
  double energy(const Eigen::Vector3d& o) const;

 private:
  double facet_energy(const Eigen::Vector3d& o) const;
  Cavity swapped() const { return Cavity(-facet_.head<2>()); }

  Eigen::Vector3d facet_, dual_;
};

/// A mixture of cavities, in double precision and without regard to speed: seeds of the map `spacing` texels
/// apart, weighted by a Gaussian about the footprint's mean [Che19 Eqs. 16 and 17], and facets whose normals
/// are spread about the seed's by a Gaussian of the roughness on the disk. Each of these has a dual of its
/// own: the roughness blurs the two normals of [Che19] Eq. 1, where the paper blurs the mirrors' BRDF. What
/// it pushes off the disk never leaves by one bounce.
/// Thread-safe; keeps a reference to the surface.
class CavityMixture {
 public:
  /// @param per_texel seeds a texel and axis: 1 or 2, at texel centres first for interpolated maps.
  CavityMixture(const Surface& surface, int per_texel) : surface_(surface), per_texel_(per_texel) {}

  /// f_1(o, i) max(i.g, 0). [Che19] Eq. 17
  double single(const BrdfQuery& query) const;
  std::vector<double> single(const std::vector<BrdfQuery>& queries) const;  ///< in parallel, in order

  /// Share of light from the view that leaves after one bounce. [Che19] Eq. 15
  double energy(const ViewQuery& query) const;

 private:
  struct Seed {
    Eigen::Vector2d normal;  ///< on the disk
    double weight;           ///< sums to 1
  };
  std::vector<Seed> seeds(const Footprint& footprint) const;

  const Surface& surface_;
  int per_texel_;
};

/// f_1(o, i) max(i.g, 0) of facets with the density `facets` of normals on the disk, at the half vector h and
/// at -h. [Che19] Eq. 7 for mirrors
double mirrored(const Eigen::Vector3d& o, const Eigen::Vector3d& i, double facets);

/// `Cavity::energy` averaged over facets that a Gaussian of the roughness spreads about `facet`.
double blurred_energy(const Eigen::Vector3d& o, const Eigen::Vector2d& facet, double roughness);

}  // namespace mica::host::reference
