#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "host/methods/beckmanns/lobe_query.h"

namespace mica::host {

/// The integer j that `uniform` picks with a probability in proportion to exp(-(j - mean)^2 / (2 sigma^2)).
/// @param sigma at least 0.4; @param uniform in [0, 1).
long pick_on_lattice(double mean, double sigma, double uniform);

/// A point of the lattice of integers, drawn with a probability in proportion to exp(-d^T C^-1 d / 2), d its
/// difference from the mean.
struct LatticePoint {
  long i = 0, j = 0;
};
/// @param covariance C; at least 0.16 in every direction. @param uniforms in [0, 1). @param key of the random
/// numbers that are drawn besides: few points are refused, and drawn anew.
LatticePoint pick_on_lattice(const Eigen::Vector2d& mean, const Eigen::Matrix2d& covariance,
                             const std::array<double, 2>& uniforms, std::uint64_t key);

/// Draws normals of a footprint on a mixture of lobes: an element by its weight, then a slope of its lobe.
/// [Che18] sec. 5, where the normal is that of a point under the footprint; here the density is that of the
/// mixture itself, without a rest.
class LobeSampler {
 public:
  /// @param structure must outlive this.
  LobeSampler(const LobeStructure& structure, const LobeGrid& grid) : structure_(structure), grid_(grid) {}

  /// A unit normal, distributed with the density D(h) (h.g) per steradian.
  /// @param uniforms in [0, 1): of the element's row and column, and of its lobe. @param key of the random
  /// numbers that are drawn besides: few elements are refused, and drawn anew.
  Eigen::Vector3d draw(const Footprint& footprint, double roughness, const std::array<double, 4>& uniforms,
                       std::uint64_t key) const;

 private:
  const LobeStructure& structure_;
  LobeGrid grid_;
};

}  // namespace mica::host
