#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "host/base/query.h"
#include "host/surface/surface.h"

namespace mica::host::reference {

struct BinningSettings {
  std::uint64_t samples = 100'000'000;
  int bins = 256;  ///< a side
  /// The square of normals that is binned; the default is the one around the unit disk.
  Eigen::Vector2d window_center = Eigen::Vector2d::Zero();
  double window_radius = 1;  ///< half its side
  std::uint64_t seed = 1;
};

/// How often each normal occurred. counts + outside_window + left_disk add up to samples.
struct BinnedNdf {
  BinningSettings settings;
  std::vector<std::uint64_t> counts;  ///< bins x bins, s to the right, t upwards, row of the lowest t first
  std::uint64_t outside_window = 0;   ///< on the disk, but not in the window
  std::uint64_t left_disk = 0;        ///< perturbed to |s| >= 1, [Yan14] sec. 3

  /// Mean of D over bin (i, j).
  double density(int i, int j) const;
  /// Centre of bin (i, j) on the disk.
  Eigen::Vector2d bin_center(int i, int j) const;
  double bin_side() const { return 2 * settings.window_radius / settings.bins; }
};

/// The second opinion on Eq. 6 of [Yan14], by its sec. 5: sample G_p, look up the normal, perturb it by G_r,
/// count bins: of n(u) - H (u - c), where the half vector turns. The half vector itself plays no part. Runs
/// in parallel; the same for any number of threads. Throws UsageError for a footprint or roughness that the
/// oracle refuses, and for bins < 1, samples < 1 or a window that is not positive.
BinnedNdf bin_normals(const Surface& surface, const Query& query, const BinningSettings& settings);

}  // namespace mica::host::reference
