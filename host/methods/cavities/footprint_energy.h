#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "host/base/query.h"
#include "host/methods/cavities/energy_table.h"
#include "host/methods/cavities/footprint_pyramid.h"
#include "host/surface/surface.h"

namespace mica::host {

/// Energy that one bounce inside V-shaped cavities loses under a footprint, from the moments of slopes alone:
/// as if those of a square of texels were a Gaussian, with a roughness along each axis of their covariance.
/// [Che19] Eq. 18; [Dupuy et al. 2013], LEADR mapping. A footprint sees a few squares about as wide as
/// itself.
///
/// Slopes that are no Gaussian may lose less than that, and the patch would reflect more light than it gets.
/// So every square knows which share of the Gaussian's loss it has at least, by comparison with its own
/// texels in a set of views: the estimate is made with that share.
class FootprintEnergy {
 public:
  explicit FootprintEnergy(const Surface& surface);

  /// Lost share, 0 to 1, of light from a view above the horizon. Of footprints narrower than two texels,
  /// which see but a part of a square, it says less: nothing in the end.
  double lost(const ViewQuery& query) const;

  std::size_t bytes() const;

 private:
  static constexpr int kBands = 4;              // of polar angles, each with a share of its own
  static constexpr int kChannels = 4 + kBands;  // of a square: its axes, then the shares
  enum { kMajor, kMinor, kDoubleCosine, kDoubleSine, kShares };  // variances; of twice the major axis's angle
  using Pyramid = FootprintPyramid<kChannels>;

  /// @param scale of the variances; @param own variance of the roughness, which is added.
  double gaussian_lost(const Pyramid::Square& square, const Eigen::Vector3d& view, double scale,
                       double own) const;
  void compare(const Surface& surface, const Eigen::Vector3d& view, int band);

  int width_, height_;
  EnergyTable table_;
  Pyramid pyramid_;
};

/// Bytes of it for a map of this size.
std::size_t footprint_energy_bytes(int width, int height);

}  // namespace mica::host
