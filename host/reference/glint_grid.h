#pragma once

#include <cstdint>
#include <vector>

#include "host/base/glints.h"
#include "host/base/query.h"

namespace mica::host::reference {

/// What is random about the glint of a cell; kernels/grid/glint_hash.h, written again.
struct Glint {
  Eigen::Vector2d place, angle;  ///< in the cell, (0, 1)^2: on the surface, on the disk
  double roulette;               ///< (0, 1): whether it is on its level
  double presence;               ///< (0, 1): whether its process has it
  double color;                  ///< (0, 1), whose part of the colours says which
};
/// The glint of the spatial cell (i, j) and the angular cell (k, l) of a level.
Glint glint_of_cell(std::int64_t i, std::int64_t j, std::int64_t k, std::int64_t l, int level,
                    std::uint32_t seed);

/// A glint surface as [Kem25] Algorithm 1 defines it, in double precision and without regard to speed; and as
/// docs/grid.md does where the half vector turns over the footprint.
struct GlintProcess {
  GlintProcess() = default;
  explicit GlintProcess(const GlintPoint& point);

  bool beckmann = false;                ///< else Trowbridge-Reitz
  double alpha_x = 0.3, alpha_y = 0.3;  ///< roughness
  double density = 1e6;                 ///< cells per unit area of uv
  double stretch = 1;                   ///< how much longer each glint is along u
  std::uint32_t seed = 1;
  double share = 1;       ///< share of the light
  double kept = 1;        ///< share of the glints that are there
  int angular_cells = 2;  ///< cells a side of the disk whose glints are seen; the expectation of others.
                          ///< Even: 2 by definition

  /// Density of normals over the disk at the query's half vector.
  double density_of(const Query& query) const { return densities_of(query, 1).front(); }
  /// What the glints of each of `colors` colours add to it.
  std::vector<double> densities_of(const Query& query, int colors) const;

  /// D of the smooth distribution, per area of the disk (s, t).
  double smooth_density(const Eigen::Vector2d& half_vector) const;
  /// T: to the unit square, in whose inscribed disk glints are uniform.
  Eigen::Vector2d to_disk(const Eigen::Vector2d& half_vector) const;
  Eigen::Vector2d from_disk(const Eigen::Vector2d& point) const;
  /// The Jacobian of `to_disk`, at half vectors on the disk.
  Eigen::Matrix2d map_jacobian(const Eigen::Vector2d& half_vector) const;
  /// Mean of `smooth_density` over the query's footprint where its half vector turns, by nine points.
  double mean_density(const Query& query) const;
};

}  // namespace mica::host::reference
